#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Prints the ledger of every claim of the papers, results/claims.md, from the published pages.

    python3 claims.py > results/claims.md      `reproduce --publish` does it too

No answer is written by hand. Each .claims file in studies/ is of one paper and has one statement
per line, as the .printed files have (printed.py):

    title = Ankishan et al. 2016
    page = ankishan2016_sim1       # its comparisons, of the .printed file, are claims, too
    compare = "position RMSE" a < b page=PAGE where="4" says="a beats b"
    within = "scans with one" a 50 100 page=PAGE where="4" says="histories are lost"
    stated = "drive is of ([0-9]+) s" 1500 2100 page=PAGE where="4" says="it takes 30 min"
    settings = speed=3 srcd.particles=30 study=ankishan2016_sim1 where="4.1"
    open = where="4.1" says="a beats b" needs="a study of a and b"
    never = where="1" says="a is simple" because="simplicity has no unit"
    headline = ankishan2016_sim1 "position_error: a < b" says="a is the most accurate filter"

`compare` takes the answer from a column of a table of results/PAGE.md, for what printed.py has not
compared: the first number of each cell with its 95 % interval, or with the standard error behind
+-. The right side may be a number, FACTOR*LABEL, or LABEL@PAGE, a cell of another page. It is
decided where the intervals do not overlap. `within` is for columns without an interval: it is
confirmed if the number of a cell lies between two others, each a number, a cell or FACTOR*LABEL.
`stated` is confirmed if a number in a sentence of the page lies between two that the paper rounds
to its own. `settings` are what the paper prints, with the names of the study file; those of a cell
begin with its label, and `runs` are those of the page. `open` is not measured yet, and `never`
cannot be measured. `headline` is named in the first sentences if it is contradicted; its second
word is the name of a comparison in the tables.
"""
import argparse
import glob
import os
import re
import shlex
import sys
import textwrap

import printed
from printed import PrintedError, escaped, fields_of

try:
    from scipy import stats
except ImportError:
    sys.exit("claims.py: scipy is missing in this Python: bash .ci/install-packages convert, and "
             "call the script by /usr/bin/python3")

CONFIRMED, CONTRADICTED, UNDECIDED = "confirmed", "contradicted", "undecided"
NOT_YET, NEVER = "not measured yet", "cannot be measured"
AS_PRINTED, OTHERWISE = "as printed", "not as printed"
# What printed.py says of a comparison, and the answer.
VERDICTS = (("agrees", CONFIRMED), ("holds", CONFIRMED), ("not reproduced", CONTRADICTED),
            ("differs", CONTRADICTED), ("contradicted", CONTRADICTED), ("undecided", UNDECIDED),
            ("another world", "undecided: another world"), ("not measured", NOT_YET))
ORDER = (CONTRADICTED, CONFIRMED, UNDECIDED, NOT_YET, NEVER)  # of the lines of a table
PUBLISH = ": publish the page again"  # it is older than the claim
BAND_WITHIN = 0.01  # a printed band is right if its ends are off by less than this share
OURS = printed.OURS
NUMBER = re.compile(r"([0-9]+(\.[0-9]+)?(e-?[0-9]+)?|inf)$")  # else it is the label of a cell


# ---- Statements


def compare_of(text):
    words = shlex.split(text)
    if len(words) < 4 or words[2] not in ("<", ">"):
        raise ValueError('write compare = "COLUMN" LABEL < LABEL page=... where=... says=...')
    fields = fields_of(words[4:], ["page", "where", "says"], [])
    return fields | dict(zip(("column", "left", "relation", "right"), words))


def within_of(text):
    words = shlex.split(text)
    if len(words) < 4:
        raise ValueError('write within = "COLUMN" LABEL LEAST MOST page=... where=... says=...')
    return (fields_of(words[4:], ["page", "where", "says"], []) |
            {"column": words[0], "left": words[1], "ends": words[2:4]})


def stated_of(text):
    words = shlex.split(text)
    if len(words) < 3:
        raise ValueError('write stated = "WORDS ([0-9]+)" LEAST MOST page=... where=... says=...')
    return (fields_of(words[3:], ["page", "where", "says"], []) |
            {"words": re.compile(words[0]), "ends": tuple(map(float, words[1:3]))})


def settings_of(text):
    words = shlex.split(text)
    own = [word for word in words if word.partition("=")[0] in ("study", "where")]
    settings = [tuple(word.split("=", 1)) for word in words if word not in own]
    if not settings or any(len(setting) != 2 for setting in settings):
        raise ValueError("write settings = NAME=VALUE... study=... where=...")
    return fields_of(own, ["study", "where"], []) | {"settings": settings}


def open_of(text):
    return fields_of(shlex.split(text), ["where", "says", "needs"], ["study"])


def never_of(text):
    return fields_of(shlex.split(text), ["where", "says", "because"], [])


def headline_of(text):
    words = shlex.split(text)
    if len(words) != 3:
        raise ValueError('write headline = PAGE "NAME" says="..."')
    return {"row": (words[0], words[1])} | fields_of(words[2:], ["says"], [])


def read_claims(path):
    """The statements of a .claims file as a dictionary by key. Raises PrintedError."""
    parsers = {"title": str, "page": str, "compare": compare_of, "within": within_of,
               "stated": stated_of, "settings": settings_of, "open": open_of, "never": never_of,
               "headline": headline_of}
    claims = printed.read_statements(path, parsers, set(parsers) - {"title"})
    if claims["title"] is None:
        raise PrintedError(f"{path}: title = ... is missing: add it")
    return claims | {"path": path}


# ---- Pages and studies


def content_of(path, what):
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except (OSError, UnicodeDecodeError) as error:
        raise PrintedError(f"{path}: {what} cannot be read ({error}): correct its name") from None


def number_of(text, runs):
    """(mean, lower, upper) of "m [l, u]" or of "m +- standard error", else None."""
    found = re.match(r"(\S+) \[([^,]+), ([^]]+)\]$", text)
    if found:
        return tuple(map(float, found.groups()))
    found = re.match(r"(\S+) \+- (\S+)", text)
    if not found or runs < 2:
        return None
    mean, error = map(float, found.groups())
    half = error * stats.t.ppf(0.5 + printed.LEVEL / 2, runs - 1)
    return mean, mean - half, mean + half


class Page:
    """The tables of a published page."""

    def __init__(self, folder, name):
        self.path = os.path.join(folder, "results", f"{name}.md")
        text = content_of(self.path, "the page")
        self.text = text
        runs = re.search(r": (\d+) of \d+ runs", text)
        self.runs = int(runs[1]) if runs else 0
        self.study = "".join(re.findall(r"^Study: .*/studies/(\w+)\.ini\)", text, re.M))
        self.tables, in_table = [], False
        for line in text.splitlines():
            if line.startswith("|"):
                if not in_table:
                    self.tables.append([])
                cells = re.split(r"(?<!\\)\|", line)[1:-1]
                self.tables[-1].append([re.sub(r"\\(.)", r"\1", cell.strip()) for cell in cells])
            in_table = line.startswith("|")

    def comparisons(self):
        """{key_of(statement): (measured, verdict)} of what printed.py compared."""
        found = {}
        for heading, _, *rows in self.tables:
            if heading[0] == "paper says":
                found |= {(row[0],): (of_interval(row[1], row[2]), row[3]) for row in rows}
            elif heading[2:3] == ["paper printed"]:
                found |= {(row[0], (row[1], row[2])): (of_interval(row[3], row[4]), row[5])
                          for row in rows}
        return found

    def text_in(self, column, label):
        """The text of the first cell in a column, of tables in which a row is a cell of the study
        or a size; in those of sweeps it is a value of an option."""
        tables = [table for table in self.tables if table[0][0] != "filter"]
        names = [[re.sub(r" \[.*", "", name) for name in table[0]] for table in tables]
        if not any(column in row for row in names):
            raise PrintedError(f"{self.path}: no table has the column '{column}': correct it")
        for row, table in zip(names, tables):
            for line in table[2:]:
                if column in row and line[0] == label:
                    return line[row.index(column)]
        raise PrintedError(f"{self.path}: no table has '{column}' of cell '{label}': correct it")

    def bare_number(self, column, label):
        """The first number of a cell in a column, which needs no interval."""
        text = self.text_in(column, label)
        try:
            return float(text.split()[0])
        except (ValueError, IndexError):
            raise PrintedError(f"{self.path}: '{column}' of {label} is no number: take another "
                               "column") from None

    def number(self, column, label):
        """The first number of a cell in a column: (mean, lower, upper)."""
        number = number_of(self.text_in(column, label), self.runs)
        if number is None:
            raise PrintedError(f"{self.path}: '{column}' of {label} has no interval: take a column "
                               "that has")
        return number


def key_of(statement):
    """What the tables of pages call a statement of a .printed file: (cell, (metric, printed)) of a
    number, and (claim,) of a claim."""
    if "cell" in statement:
        return statement["cell"], (printed.name_of_value(statement), statement["printed"])
    return (printed.name_of_claim(statement),)


def of_interval(measured, interval):
    return measured + ("" if interval == "-" else f" {interval}")


class Study:
    """The settings of a study file, and the options of its cells {label: {option: value}}."""

    def __init__(self, folder, name):
        self.path = os.path.join(folder, "studies", f"{name}.ini")
        self.defaults = os.path.join(folder, "study", "setting_table.cpp")
        self.sources = glob.glob(os.path.join(folder, "..", "filters", "*", "*.[ch]pp"))
        self.settings, self.cells = {}, {}
        for line in content_of(self.path, "the study").splitlines():
            key, equals, value = (part.strip() for part in line.partition("#")[0].partition("="))
            if key == "cell":
                self.add_cells(value)
            elif equals:
                self.settings[key] = value

    def add_cells(self, text):
        filter_name, *options = text.split()
        options = dict(option.split("=", 1) for option in options)
        counts = options.get("particles", "").split(",")
        label = options.get("label", filter_name)
        for count in counts:
            name = f"{label}_m{count}" if len(counts) > 1 else label
            self.cells[name] = options | {"particles": count}

    def check(self, label):
        if label not in self.cells:
            raise PrintedError(f"{self.path}: there is no cell '{label}': correct the label (there "
                               f"are {', '.join(self.cells)})")

    def value(self, name):
        """The value of a setting, or its default."""
        label, dot, option = name.partition(".")
        if dot:
            self.check(label)
        value = self.cells[label].get(option) if dot else self.settings.get(name)
        if value is not None:
            return value
        defaults = [] if dot else re.findall(rf'"{name}", "[^"]*", "([^"]+)"',
                                             content_of(self.defaults, "the table of defaults"))
        # Filters and vehicles have theirs in their sources.
        found = set(defaults) or {default for path in self.sources for default in re.findall(
            rf'parameter\(\s*"{option or name}",\s+"([^"]+)"', content_of(path, "a source"))}
        if len(found) != 1:
            raise PrintedError(f"{self.path}: there is no setting '{name}', or not one default of "
                               "it: correct the name, or write it in the study")
        return found.pop()


# ---- Answers


def row_of(claim, where, measured, answer, **others):
    """A line of the ledger. `page` answers the claim, `rest` is what the answer adds, and `name`
    is that of a comparison."""
    others = {"page": "", "rest": "", "name": "", "is_number": False} | others
    return {"claim": claim, "where": where, "measured": measured, "answer": answer} | others


def answer_of(verdict):
    """The answer to a verdict of printed.py, and its remainder."""
    for beginning, answer in VERDICTS:
        if verdict.startswith(beginning):
            answer, colon, rest = answer.partition(":")
            return answer, colon + rest + verdict.removeprefix(beginning)
    raise PrintedError(f"'{verdict}' is no verdict of printed.py: add it to claims.py")


def decided(relation, left, right):
    """The answer where numbers with intervals are compared."""
    if relation == ">":
        left, right = right, left
    return (CONFIRMED if left[2] < right[1] else CONTRADICTED if left[1] > right[2] else UNDECIDED)


class Ledger:
    """All claims of the .claims files and of the .printed files that they name."""

    def __init__(self, folder):
        self.folder = folder
        self.pages, self.studies = {}, {}
        sources = glob.glob(os.path.join(folder, "..", "analysis", "metrics", "*.cpp"))
        self.metrics = set(re.findall(r'{"([a-z0-9_]+)", "', "".join(
            content_of(path, "a metric") for path in sources)))
        self.papers = [read_claims(path) for path in
                       sorted(glob.glob(os.path.join(folder, "studies", "*.claims")))]
        for paper in self.papers:
            paper["rows"] = [row for page in paper["page"] for row in self.printed_rows(page)]
            paper["rows"] += map(self.compared, paper["compare"])
            paper["rows"] += map(self.within, paper["within"])
            paper["rows"] += map(self.stated, paper["stated"])
            paper["rows"] += map(self.opened, paper["open"])
            paper["rows"] += [row_of(each["says"], each["where"], "-", NEVER,
                                     rest=f", because {each['because']}")
                              for each in paper["never"]]
            paper["set"] = [self.set_row(each) for each in paper["settings"]]
        self.check_pages()
        self.rows = [row for paper in self.papers for row in paper["rows"] if not is_ours(row)]
        self.headlines = [headline for paper in self.papers for headline in paper["headline"]
                          if self.row_named(*headline["row"])["answer"] == CONTRADICTED]

    def page(self, name):
        if name not in self.pages:
            self.pages[name] = Page(self.folder, name)
        return self.pages[name]

    def study(self, name):
        if name not in self.studies:
            self.studies[name] = Study(self.folder, name)
        return self.studies[name]

    def check_metric(self, metric, path):
        if not set(printed.columns_of(metric)) <= self.metrics:
            raise PrintedError(f"{path}: there is no metric '{metric}': correct it")

    def printed_rows(self, page):
        """The claims of the .printed file of a page's study, answered by the page."""
        study = self.page(page).study
        path = os.path.join(self.folder, "studies", f"{study}.printed")
        paper, compared = printed.read_printed(path), self.page(page).comparisons()
        statements = paper["value"] + paper["claim"]
        rows = []
        for each in statements:
            self.check_metric(each["metric"], path)
            for key in ("cell", "relative_to", "left", "right"):
                if key in each:
                    self.study(study).check(each[key])
            in_table = key_of(each)
            if sum(key_of(other) == in_table for other in statements) > 1:
                raise PrintedError(f"{path}: {in_table} is given twice: remove one of the two")
            name = in_table[0] + "".join(f": {what} {number}" for what, number in in_table[1:])
            measured, verdict = compared.pop(in_table, ("-", None))
            answer, rest = answer_of(verdict) if verdict else (NOT_YET, PUBLISH)
            in_words = name.replace(each["metric"], each["metric"].replace("_", " "))
            rows.append(row_of(in_words, each.get("note", ""), measured, answer, page=page,
                               rest=rest, name=name, is_number="cell" in each))
        if compared:
            raise PrintedError(f"{path}: the page {page} compares {next(iter(compared))}, which is "
                               "no claim: add the statement")
        return rows + [band_row(page, paper["runs"], *band) for band in paper["band"].items()]

    def compared(self, claim):
        page = self.page(claim["page"])
        left = page.number(claim["column"], claim["left"])
        side = printed.RIGHT_SIDE.match(claim["right"])
        if side["number"]:
            right, against = [float(side["number"])] * 3, ""
        else:
            label, _, other = side["label"].partition("@")
            right = [float(side["factor"] or 1) * end for end in
                     (self.page(other) if other else page).number(claim["column"], label)]
            against = " against " + of_numbers(right)
        name = f"{claim['column']}: {claim['left']} {claim['relation']} {claim['right']}"
        return row_of(f"{claim['says']}; {name}", claim["where"], of_numbers(left) + against,
                      decided(claim["relation"], left, right), page=claim["page"], name=name)

    def within(self, claim):
        page = self.page(claim["page"])
        column, (least, most) = claim["column"], claim["ends"]
        number = page.bare_number(column, claim["left"])
        sides = [printed.RIGHT_SIDE.match(end) for end in claim["ends"] if not NUMBER.match(end)]
        cells = {side[0]: float(side["factor"] or 1) * page.bare_number(column, side["label"])
                 for side in sides}
        lower, upper = (cells[end] if end in cells else float(end) for end in claim["ends"])
        others = [page.text_in(column, side["label"]) for side in sides]
        against = f" against {' and '.join(others)}" if others else ""
        name = f"{column}: {claim['left']} from {least} to {most}"
        return row_of(f"{claim['says']}; {name}", claim["where"],
                      page.text_in(column, claim["left"]) + against,
                      CONFIRMED if lower <= number <= upper else CONTRADICTED,
                      page=claim["page"], name=name)

    def stated(self, claim):
        page = self.page(claim["page"])
        found = claim["words"].search(" ".join(page.text.split()))
        if not found:
            raise PrintedError(f"{page.path}: no sentence has '{claim['words'].pattern}': correct "
                               "it, or publish the page again")
        least, most = claim["ends"]
        answer = CONFIRMED if least <= float(found[1]) <= most else CONTRADICTED
        return row_of(claim["says"], claim["where"], found[1], answer, page=claim["page"])

    def opened(self, claim):
        if "study" in claim:
            self.study(claim["study"])
        needs = f"{claim['study']}: {claim['needs']}" if "study" in claim else claim["needs"]
        return row_of(claim["says"], claim["where"], "-", NOT_YET,
                      rest=": needs " + needs.replace("=", " = "))  # a narrow page can break there

    def set_row(self, claim):
        study = self.study(claim["study"])
        ours = {name: str(self.page(claim["study"]).runs) if name == "runs" else study.value(name)
                for name, _ in claim["settings"]}
        other = [f"{name} = {ours[name]}" for name, value in claim["settings"]
                 if ours[name] != value]
        return row_of(", ".join(f"{name} = {value}" for name, value in claim["settings"]),
                      claim["where"], ", ".join(other) or "-", OTHERWISE if other else AS_PRINTED,
                      study=claim["study"])

    def check_pages(self):
        """Raises PrintedError if the comparisons of a page are not in the ledger."""
        listed = {page for paper in self.papers for page in paper["page"]}
        for path in glob.glob(os.path.join(self.folder, "results", "*.md")):
            name = os.path.basename(path).removesuffix(".md")
            if name not in listed | {"claims"} and self.page(name).comparisons():
                raise PrintedError(f"{path}: no .claims file names this page of comparisons: add "
                                   f"page = {name}")

    def row_named(self, page, name):
        for row in self.rows:
            if (row["page"], row["name"]) == (page, name):
                return row
        raise PrintedError(f"headline: page {page} has no comparison '{name}': correct it")

    def count(self, answer, **others):
        wanted = others | {"answer": answer}
        return sum(wanted.items() <= row.items() for row in self.rows)


def band_row(page, runs, block, band):
    """The claim that a printed band is that of so many runs."""
    d = printed.DIMENSIONS[block]
    right = [end / runs for end in stats.chi2.interval(printed.LEVEL, runs * d)]
    off = max(abs(end / ours - 1.0) for end, ours in zip(band, right))
    claim = f"band of the NEES of the {block}: {printed.interval_text(band)}"
    return row_of(claim, f"95 % of {runs} runs", printed.interval_text(right),
                  CONFIRMED if off < BAND_WITHIN else CONTRADICTED, page=page)


def is_ours(row):
    return row["where"].startswith(OURS)


def of_numbers(number):
    return f"{printed.number_text(number[0])} {printed.interval_text(number[1:])}"


# ---- Markdown


def print_text(text):
    print("\n" + textwrap.fill(text, 100, break_long_words=False, break_on_hyphens=False))


def print_rows(title, rows):
    # The answer comes first, since a phone shows only the first columns.
    print(f"\n## {title}\n\n| answer | claim | where | measured [95 %] |\n|---|---|---|---|")
    for row in sorted(rows, key=lambda row: ORDER.index(row["answer"])):
        answer = f"[{row['answer']}]({row['page']}.md)" if row["page"] else row["answer"]
        found = [part for part in (row["measured"], row["rest"].lstrip(",: "))
                 if part not in ("", "-")]
        print(f"| {answer} | {escaped(row['claim'])} | {escaped(row['where'])} | "
              f"{escaped('; '.join(found)) or '-'} |")


def print_settings(rows):
    print("\n## Settings that the papers print\n\n| answer | printed | where | "
          "the study has instead |\n|---|---|---|---|")
    for row in rows:
        print(f"| [{row['answer']}](../studies/{row['study']}.ini) | {escaped(row['claim'])} | "
              f"{escaped(row['where'])} | {escaped(row['measured'])} |")


def print_ledger(ledger):
    print("# What the papers claim, and what was measured")
    unpublished = ledger.count(NOT_YET, rest=PUBLISH)
    again = (f" ({unpublished} of them need no new study, only that a page is published again)"
             if unpublished else "")
    open_ones = ledger.count(NOT_YET)
    print_text(
        f"Of {len(ledger.rows)} claims, {ledger.count(CONFIRMED)} are confirmed, "
        f"{ledger.count(CONTRADICTED)} contradicted, {ledger.count(UNDECIDED)} undecided, "
        + (f"{open_ones} not measured yet{again}, " if open_ones else "") + "and "
        f"{ledger.count(NEVER)} cannot be measured. Of those confirmed, "
        f"{ledger.count(CONFIRMED, is_number=True)} are printed numbers. "
        + "".join(["Contradicted is, above all, ", ", ".join(
            f"[that {each['says']}]({each['row'][0]}.md)" for each in ledger.headlines), "."]
            if ledger.headlines else []))
    print_text(
        "This page was written by `experiments/claims.py` from the other pages. *Where* is the "
        "section, equation, table or figure. Names of cells and "
        "metrics are those of the page that the answer leads to, which says what was assumed, as "
        "does the .printed file of its study, which may be newer. "
        "A claim *metric: a < b* is answered by the difference a - b, run by run, and *a ~ b* "
        "holds if they differ by less than 10 %, so that *a < b* and *a ~ b* may both be true. A "
        "number that the paper printed of one run is *confirmed* if it lies among our runs. A "
        "claim about a band is tried on batches of as many runs as in the paper, and is "
        "*undecided* unless all agree. Claims of our own, in the last table but one, are not "
        "counted. A claim in words "
        "with a column of a page is answered by both numbers, and decided if their intervals do "
        "not overlap; *from a to b* is confirmed if a number whose column has no interval lies "
        "between the two. Where another world takes the place of one that the paper does not name "
        "or publish, its numbers are *undecided*. *Stays above from* is the time [s] at which the "
        "average NEES leaves its band for good, *share inside* the share of scans in the band. "
        "What *agrees* is explained in "
        "[STUDY_FILES](../STUDY_FILES.md#compare-with-what-a-paper-printed); a number that does is "
        "confirmed.")
    for paper in ledger.papers:
        print_rows(paper["title"], [row for row in paper["rows"] if not is_ours(row)])
    ours = [row for paper in ledger.papers for row in paper["rows"] if is_ours(row)]
    print_rows("Not in the papers", [row | {"where": row["page"] + row["where"][len(OURS):]}
                                     for row in ours])
    print_settings([row for paper in ledger.papers for row in paper["set"]])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args()
    try:
        print_ledger(Ledger(os.path.dirname(os.path.abspath(__file__))))
    except PrintedError as error:
        sys.exit(f"claims.py: {error}")
