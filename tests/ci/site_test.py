#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The site that .ci/build-site makes of the documents: no link leads to nothing, every equation is
drawn, the search finds, and nothing comes from a network.

usage: site_test.py [TEST...]
Exit code 77: skipped, since what .ci/build-site needs is not installed.
"""
import functools
import html.parser
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "analysis" / "render" / "page"))
import chromium  # noqa: E402

NEEDED = {"mkdocs": shutil.which("mkdocs"), "graphviz": shutil.which("dot")} | {
    package: pathlib.Path(path).exists()
    for package, path in (("mkdocs-material", "/usr/share/mkdocs/themes/material"),
                          ("libjs-mathjax", "/usr/share/javascript/mathjax/MathJax.js"))}


def build(root, folder):
    """Runs the script of the repository at `root`."""
    return subprocess.run([root / ".ci" / "build-site", folder], capture_output=True, text=True)


class Parts(html.parser.HTMLParser):
    """What a page links to and loads, where others link to, its equations, and its words without
    those of code and equations."""

    def __init__(self, path):
        super().__init__()
        self.links, self.loaded, self.names, self.words = [], [], set(), ""
        self.display, self.inside = 0, []
        self.feed(path.read_text())

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.names.add(attributes.get("id"))
        target = attributes.get("href", attributes.get("src"))
        if target is not None:
            (self.links if tag == "a" else self.loaded).append(target)
        is_equation = "arithmatex" in (attributes.get("class") or "").split()
        self.display += is_equation and tag == "div"
        if is_equation or tag in ("code", "script", "style"):
            self.inside.append(tag)

    def handle_endtag(self, tag):
        if self.inside and self.inside[-1] == tag:
            self.inside.pop()

    def handle_data(self, data):
        self.words += "" if self.inside else data


FOLDER = tempfile.TemporaryDirectory(prefix="montecarta_site_")


@functools.cache
def site():
    """The folder of the site of this repository."""
    built = build(ROOT, FOLDER.name)
    if built.returncode != 0:
        raise AssertionError(built.stderr)
    return pathlib.Path(FOLDER.name) / "site"


class Site(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.site = site()
        cls.parts = {page: Parts(page) for page in cls.site.rglob("*.html")
                     if page.name != "404.html"}  # whose links begin at the top of a server

    def page(self, name):
        return self.parts[self.site / name]

    def test_no_link_leads_to_nothing(self):
        count = 0
        for page, parts in self.parts.items():
            for link in parts.links + parts.loaded:
                url = urllib.parse.urlsplit(link)
                if url.scheme:
                    continue
                path = urllib.parse.unquote(url.path)
                target = (page.parent / path).resolve() if path else page
                self.assertTrue(target.is_file(), f"{page} links to {link}")
                if url.fragment and target in self.parts and not url.fragment.startswith("__"):
                    names = self.parts[target].names
                    self.assertIn(urllib.parse.unquote(url.fragment), names, f"{page}: {link}")
                count += 1
        self.assertGreater(count, 1000)

    def test_nothing_is_loaded_from_a_network(self):
        for page, parts in self.parts.items():
            for loaded in parts.loaded:
                self.assertEqual(urllib.parse.urlsplit(loaded).netloc, "", page)

    def test_every_document_is_a_page_and_sources_are_shown(self):
        shown = {page.relative_to(self.site).as_posix() for page in self.parts}
        self.assertTrue({"index.html", "filters/EQUATIONS.html", "experiments/results/index.html",
                         "filters/plain/index.html", "experiments/studies/first_study.ini.html",
                         "CITATION.cff.html"} <= shown, shown)
        self.assertIn("montecarta tests whether", self.page("index.html").words)

    def test_the_first_picture_is_the_replay(self):
        pictures = [p for p in self.page("index.html").loaded if p.endswith(".svg")]
        self.assertEqual(pathlib.Path(pictures[0]).name, "replay.svg")

    def test_equations_were_turned(self):
        for name in ("analysis/STATISTICS", "filters/EQUATIONS"):
            fences = (ROOT / f"{name}.md").read_text().count("```math\n")
            self.assertGreater(fences, 40)
            self.assertEqual(self.page(f"{name}.html").display, fences)
        for page, parts in self.parts.items():
            self.assertNotIn("$", parts.words, page)

    def test_the_search_leaves_sources_out(self):
        index = (self.site / "search" / "search_index.json").read_text()
        self.assertIn("analysis/STATISTICS.html#5-verdict", index)
        self.assertNotIn("first_study.ini.html", index)


@unittest.skipIf(chromium.find() is None, "there is no chromium")
class InABrowser(unittest.TestCase):
    """Read from the folder, as a reader without a server does."""

    @classmethod
    def setUpClass(cls):
        cls.browser = chromium.Browser()
        cls.addClassCleanup(cls.browser.close)

    def open(self, name, **screen):
        page = chromium.Page(self.browser, **screen)
        page.open(site() / name)
        page.evaluate("new Promise(done => MathJax.Hub.Queue(done))")
        return page

    def test_equations_are_drawn(self):
        for name in ("analysis/STATISTICS.html", "filters/EQUATIONS.html"):
            with self.subTest(name):
                page = self.open(name)
                counts = [page.evaluate(f"document.querySelectorAll('{selector}').length")
                          for selector in (".arithmatex", ".arithmatex svg", ".merror, [fill=red]")]
                self.assertGreater(counts[0], 200)
                self.assertEqual(counts, [counts[0], counts[0], 0])
                self.assertLessEqual({url.split(":")[0] for url in page.requested()},
                                     {"file", "data"})
                self.assertEqual(page.complaints_of_console(), [])

    def test_pages_fit_a_phone(self):
        for name in ("index.html", "analysis/STATISTICS.html", "ARCHITECTURE.html",
                     "experiments/results/consistency.html"):
            with self.subTest(name):
                page = self.open(name, width=390, touch=True)
                self.assertLessEqual(page.evaluate("document.documentElement.scrollWidth"), 390)

    def test_the_search_finds(self):
        page = self.open("experiments/STUDY_FILES.html")
        found = page.evaluate("""new Promise(done => {
          const results = document.querySelector('.md-search-result');
          new MutationObserver(() => {
            const link = results.querySelector('a');
            if (link) done(link.href);
          }).observe(results, {childList: true, subtree: true});
          document.querySelector('#__search').click();
          const field = document.querySelector('.md-search__input');
          field.focus();
          field.value = 'interim analyses';
          field.dispatchEvent(new KeyboardEvent('keyup', {bubbles: true}));
        })""")
        self.assertIn("STATISTICS.html", found)


class OneDocument(unittest.TestCase):
    """In a repository of one document."""

    def built(self, document, nav="- README.md"):
        folder = tempfile.TemporaryDirectory(prefix="montecarta_site_")
        self.addCleanup(folder.cleanup)
        root = self.root = pathlib.Path(folder.name)
        shutil.copytree(ROOT / ".ci", root / ".ci")
        config = root / ".ci" / "site" / "mkdocs.yml"
        config.write_text(re.sub(r"(?s)\nnav:.*", f"\nnav:\n  {nav}\n", config.read_text()))
        (root / "README.md").write_text(document)
        (root / "study.ini").write_text("[study]\n")
        return build(root, root / "build-site")

    def test_a_list_in_a_list(self):
        document = "# One\n\n- a, which\n  goes on\n  - b\n- c\n\nText.\n"
        self.assertEqual(self.built(document).returncode, 0)
        html = (self.root / "build-site" / "site" / "index.html").read_text()
        self.assertRegex(html, r"(?s)<li>a, which\s*goes on<ul>\s*<li>b</li>\s*</ul>")

    def test_no_mistake(self):
        built = self.built("# One\n\n[title](#one), [study](study.ini), `[code](study.hpp)`\n")
        self.assertEqual(built.returncode, 0, built.stderr)

    def test_a_link_to_nothing(self):
        built = self.built("# One\n\n[two](TWO.md)\n")
        self.assertEqual(built.returncode, 1)
        self.assertIn("README.md:3: links to TWO.md", built.stderr)

    def test_a_document_without_a_place(self):
        built = self.built("# One\n", nav="- OTHER.md")
        self.assertEqual(built.returncode, 1)
        self.assertIn("README.md", built.stderr)

    def test_a_place_without_a_document(self):
        built = self.built("# One\n", nav="- README.md\n  - OTHER.md")
        self.assertEqual(built.returncode, 1)
        self.assertIn("OTHER.md", built.stderr)


if __name__ == "__main__":
    missing = [package for package, is_here in NEEDED.items() if not is_here]
    if missing:
        print(f"skipped: {', '.join(missing)} not installed (bash .ci/install-packages site)")
        sys.exit(77)
    unittest.main(verbosity=2)
