# SPDX-License-Identifier: BSD-3-Clause
"""From the documents of the repository to the pages that mkdocs reads."""
import os
import pathlib
import re
import shutil
import subprocess

import yaml

LANGUAGES = {".cpp": "cpp", ".csv": "text", ".hpp": "cpp", ".ini": "ini", ".m": "matlab",
             ".py": "python", ".cff": "yaml"}
VERBATIM = {"experiments/commands/commands.md"}  # the program prints its sections as they stand
PICTURES = {".svg", ".png"}

FENCE = re.compile(r"\s*(```+|~~~+)")
ITEM = re.compile(r"([-*]|\d+\.) ")
CODE_SPAN = re.compile(r"(`+)(?!`).*?(?<!`)\1(?!`)")
LINK = re.compile(r"(\]\()([^)#:\s]+)((?:#[^)\s]*)?\))")


class SiteError(Exception):
    """The documents make no site; the message says where and why."""


def documents(root):
    """Paths, from `root`, of its documents in Markdown. These begin with a title; other texts in
    Markdown are read by the program, or are a paper."""
    folders = [f for f in sorted(root.iterdir()) if (f / "README.md").exists()]
    texts = sorted(root.glob("*.md")) + [t for f in folders for t in sorted(f.rglob("*.md"))]
    return [t.relative_to(root).as_posix() for t in texts if t.read_text().startswith("# ")]


def source_pages(folder):
    """Names of the pages below folder/pages that show a source or list a folder."""
    return (folder / "sources.txt").read_text().splitlines()


class Pages:
    """Writes pages, and remembers which sources they link to."""

    def __init__(self, root, to):
        self.root = root
        self.to = to
        self.documents = set(documents(root))
        self.linked = {}  # page -> the source or folder that it shows

    def write(self, path, text):
        (self.to / path).parent.mkdir(parents=True, exist_ok=True)
        (self.to / path).write_text(text)

    def page_of(self, path):
        """The page that shows the source or folder at `path`."""
        page = f"{path}/README.md" if (self.root / path).is_dir() else f"{path}.md"
        if page not in self.documents:
            self.linked.setdefault(page, path)
        return page

    def target(self, document, line, link):
        """`link` as it stands in a document, or to the page of the source that it leads to."""
        folder = os.path.dirname(document)
        path = os.path.normpath(os.path.join(folder, link))
        if path.startswith("..") or not (self.root / path).exists():
            raise SiteError(f"{document}:{line}: links to {link}, which does not exist")
        if path in self.documents:
            return link
        if pathlib.Path(path).suffix in PICTURES:
            (self.to / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(self.root / path, self.to / path)
            return link
        return os.path.relpath(self.page_of(path), folder or ".")

    def copy(self, document):
        """Copies a document. Its links to what is no document lead to pages, and its diagrams
        become pictures."""
        lines, fence, diagram, in_list = [], None, None, False
        for number, line in enumerate((self.root / document).read_text().splitlines(), 1):
            begin = FENCE.match(line)
            if fence is None and begin:
                fence = begin[1]
                diagram = [] if line.strip() == "```mermaid" else None
            elif fence is not None and line.strip() == fence:
                fence = None
                if diagram is not None:
                    lines.append(self.picture(document, number, diagram))
                    diagram = None
                    continue
            elif fence is None:
                line = self.relinked(document, number, line)
                if line and not line.startswith(" "):
                    in_list = ITEM.match(line) is not None or (in_list and lines[-1] != "")
                if in_list:  # where mkdocs wants four spaces for a list in a list, GitHub two
                    line = " " * (len(line) - len(line.lstrip())) + line
            if diagram is None:
                lines.append(line)
            elif not begin:
                diagram.append(line)
        text = "\n".join(lines) + "\n"
        if document in VERBATIM:
            section = r"(?sm)^(## [^\n]*)\n(.*?)\n(?=## |\Z)"
            text = re.sub(section, r"\1\n\n~~~text\n\2\n~~~\n\n", text)
        self.write(document, text)

    def relinked(self, document, number, line):
        """`line` with other links, except in code."""
        def other(match):
            return match[1] + self.target(document, number, match[2]) + match[3]

        parts, end = [], 0
        for span in CODE_SPAN.finditer(line):
            # A link may have code in its text: its '](' follows the code.
            parts += [LINK.sub(other, line[end:span.start()]), span[0]]
            end = span.end()
        return "".join(parts) + LINK.sub(other, line[end:])

    def picture(self, document, number, diagram):
        name = f"{pathlib.Path(document).stem.lower()}_{number}.svg"
        if shutil.which("dot") is None:
            raise SiteError("no dot, which draws diagrams: run 'bash .ci/install-packages site'")
        dot = subprocess.run(["dot", "-Tsvg"], input=dot_of(document, diagram), text=True,
                             stdout=subprocess.PIPE, check=True)
        self.write(os.path.join(os.path.dirname(document), name), dot.stdout)
        return f"![Diagram]({name})"

    def show(self, page, path):
        """Writes the page of a source, with the source beside it, or of a folder."""
        source = self.root / path
        if source.is_dir():
            here = [p for p in sorted(source.iterdir())
                    if p.suffix in LANGUAGES or p.suffix == ".md" and not p.name.startswith(".")]
            if not here:
                raise SiteError(f"{path}: is linked to and has nothing to show")
            names = [p.name for p in here]
            rows = [f"- [{n}]({os.path.relpath(self.page_of(f'{path}/{n}'), path)})" for n in names]
            self.write(page, f"# {path}\n\n" + "\n".join(rows) + "\n")
            return
        name = f"`{path}`"
        if source.suffix != ".md":  # which would be a page
            self.write(path, source.read_text())
            name = f"[{name}]({source.name}) as a file"
        language = LANGUAGES.get(source.suffix, "text")
        self.write(page, f"# {source.name}\n\n{name}\n\n"
                         f"~~~~~~{language}\n{source.read_text()}\n~~~~~~\n")


def dot_of(document, diagram):
    """The flowchart of mermaid in the language of Graphviz."""
    node = r"(\w+)(?:\[(\(?)(.*?)\)?\])?"
    arrow = re.compile(rf"\s*{node}\s*-->(?:\|(.*?)\|)?\s*{node}\s*$")
    style = 'fontname="sans-serif", fontsize=11'
    lines = [f'node [shape=box, style=rounded, {style}]; edge [{style}, color="#777777"];']
    for line in diagram:
        match = arrow.match(line)
        if match is None:
            if line.strip() == "flowchart TD":
                continue
            raise SiteError(f"{document}: '{line.strip()}' is no arrow that pages.py reads")
        start, start_box, start_text, label, end, end_box, end_text = match.groups()
        for name, box, text in ((start, start_box, start_text), (end, end_box, end_text)):
            if text:
                shape = ", shape=cylinder, style=solid" if box else ""
                lines.append(f'{name} [label="{broken(text, 22)}"{shape}];')
        lines.append(f'{start} -> {end} [label="{broken(label or "", 18)}"];')
    return "digraph { ranksep=0.35; nodesep=0.25;\n" + "\n".join(lines) + "\n}\n"


def broken(text, width):
    """Words in lines of about `width` characters."""
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + len(word) > width:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return "\\n".join(lines)


def navigation(text, documents_left):
    """mkdocs.yml with a line for each document that a pattern in it means, and no other does."""
    lines = []
    for line in text.splitlines():
        match = re.fullmatch(r"( *- )(\S+/)\*\.md", line)
        if match is None:
            lines.append(line)
            continue
        rest = sorted(d for d in documents_left if os.path.dirname(d) == match[2].rstrip("/"))
        lines += [f"{match[1]}{pathlib.Path(d).stem}: {d}" for d in rest]
        documents_left -= set(rest)
    if documents_left:
        raise SiteError("no place in the nav of .ci/site/mkdocs.yml: "
                        + ", ".join(sorted(documents_left)))
    return "\n".join(lines) + "\n"


def named_in(entry):
    """The documents that an entry of a nav names."""
    if isinstance(entry, str):
        return {entry}
    inner = entry.values() if isinstance(entry, dict) else entry
    return set().union(*map(named_in, inner))


def write(root, folder):
    """Writes folder/pages, folder/mkdocs.yml and folder/sources.txt."""
    own = root / ".ci" / "site"
    pages = Pages(root, folder / "pages")
    text = (own / "mkdocs.yml").read_text()
    nav = yaml.safe_load(text[text.index("\nnav:"):])["nav"]
    config = navigation(text, pages.documents - named_in(nav))
    for document in sorted(pages.documents):
        pages.copy(document)
    shown = {}
    while left := {p: s for p, s in pages.linked.items() if p not in shown}:  # folders link on
        for page, source in left.items():
            pages.show(page, source)
        shown |= left
    for name in ("style.css", "equations.js"):
        shutil.copy(own / name, pages.to / name)
    shutil.copytree(own / "theme", folder / "theme")
    (folder / "sources.txt").write_text("".join(f"{page}\n" for page in sorted(shown)))
    (folder / "mkdocs.yml").write_text(config)
