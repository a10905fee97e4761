# SPDX-License-Identifier: BSD-3-Clause
"""The paper, experiments/paper/paper.md: its numbers stand on the published pages that it names,
and its references in its bibliography."""
import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAPER = ROOT / "experiments" / "paper"
RESULTS = ROOT / "experiments" / "results"


def as_printed(number):
    """21,900 as the pages print it."""
    number = number.replace(",", "")
    return number if float(number) < 1e4 else f"{float(number):.2e}".replace("e+0", "e")


class Paper(unittest.TestCase):
    def setUp(self):
        text = (PAPER / "paper.md").read_text()
        self.results = " ".join(text[text.index("# Results"):text.index("# Availability")].split())
        self.text = text

    def pages(self):
        """The text of the pages that the results name."""
        names = set(re.findall(r"`(\w+\.md)`", self.results))
        self.assertGreaterEqual(names, {"consistency.md", "claims.md"})
        return " ".join(" ".join((RESULTS / name).read_text().split()) for name in names)

    def test_ratios_stand_on_the_pages(self):
        pages = self.pages()
        number = r"([\d.,]*\d)"
        ratios = re.findall(rf"{number}[^\d()]*\((?:95 %: )?{number} to {number}\)", self.results)
        self.assertEqual(len(ratios), 7)
        for ratio in ratios:
            middle, low, high = map(as_printed, ratio)
            self.assertIn(f"{middle} \\[{low}, {high}\\]", pages)

    def test_counts_of_claims_stand_in_the_ledger(self):
        counts = re.findall(r"Of (\d+) claims[^(]*?(\d+ are confirmed, \d+ contradicted, "
                            r"\d+ undecided, (?:\d+ not measured yet, )?and \d+ cannot)",
                            self.results)
        ledger = " ".join((RESULTS / "claims.md").read_text().split())
        ledger = re.sub(r" \([^)]*published again\)", "", ledger)  # a remark among the counts
        self.assertEqual(len(counts), 1)
        self.assertIn("Of {} claims, {}".format(*counts[0]), ledger)

    def test_references_and_figures_are_there(self):
        keys = set(re.findall(r"@([a-z]+\w*)", self.text))
        entries = set(re.findall(r"^@\w+\{(\w+),", (PAPER / "paper.bib").read_text(), re.M))
        self.assertEqual(keys, entries)
        figures = re.findall(r"\]\(([^)]*\.svg)\)", self.text)
        self.assertEqual(len(figures), 2)
        for figure in figures:
            self.assertTrue((PAPER / figure).is_file(), figure)

    def test_the_citation_has_the_version_of_the_program_and_the_authors_of_the_paper(self):
        citation = (ROOT / "CITATION.cff").read_text()
        version = re.search(r"project\(montecarta[^)]*VERSION ([\d.]+)",
                            (ROOT / "CMakeLists.txt").read_text())
        self.assertEqual(set(re.findall(r"version: ([\d.]+)$", citation, re.M)),
                         {"1.2.0", version[1]})  # that of the format, and ours
        authors = set(re.findall(r"- name: (.*)", citation))
        self.assertEqual(authors, set(re.findall(r"- name: (.*)", self.text)))
        title = re.search(r"title: '(.*)'", self.text)
        self.assertEqual(set(re.findall(r'title: "(.*)"', citation)), {title[1]})


if __name__ == "__main__":
    unittest.main(verbosity=2)
