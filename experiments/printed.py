#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares the numbers in a paper with those of `montecarta analyze FILE --csv FOLDER`, and prints
the comparison as Markdown.

    python3 printed.py studies/ankishan2016_sim1.printed FOLDER [BATCH...]

The .printed file beside a study has one statement per line:

    source = Authors: title, year; Table 1
    runs = 20                  # number of runs over which the paper averages
    baseline = fastslam2       # if its number is far off, other cells are not compared
    substitute = web_loop      # the world in place of the paper's: no number is compared
    band = position 1.3 2.79   # the band that the paper drew for its average NEES
    value = cell=srcd metric=position_rmse printed=2.8211 note="Table 1"
    value = cell=ufastslam metric=cpu_seconds printed=1.82 relative_to=fastslam2 note="Table 3"
    claim = position_rmse srcd < ufastslam note="Fig. 3"
    claim = cpu_seconds srcd_m100 < 10*srcd_m10 note="Table 2"
    assume = Loops: the paper does not say; two.

A note that begins with "not in the paper" marks a comparison of our own. --lead FILE writes three
sentences to FILE: what the paper says, what was found, and how sure that is. Cells are named by
their labels. A metric is a column of runs.csv, or COLUMN-COLUMN, the difference of two; in a claim
also variance_of_COLUMN, its variance between runs, of which the interval is linearised; or
share_inside_BLOCK, share_above_BLOCK or stays_above_from_BLOCK (pose, position, heading), which
compare the average NEES of all runs with a band: that of the paper, or else the chi-square band for
the number of runs. These metrics depend on the number of runs, so they are computed for every
BATCH, a folder that `analyze --csv` wrote for a part of the study with as many runs as in the
paper. Needs NumPy and SciPy.
"""
import argparse
import csv
import math
import os
import re
import shlex
import sys
import textwrap

try:
    import numpy as np
    from scipy import stats
except ImportError as missing:
    sys.exit(f"printed.py: {missing.name} is missing in this Python: bash .ci/install-packages "
             "convert, and call the script by /usr/bin/python3")

LEVEL = 0.95
OURS = "not in the paper"  # so begins the note of a comparison of our own
REPRODUCED_WITHIN = 2.0  # a number that is off by more than this factor is not reproduced
ALIKE_WITHIN = 0.1  # cells are alike if they differ by less than this share of their mean
VARIANCE_OF = "variance_of_"  # before a column of runs.csv
# The right side of a claim: a number, or the label of a cell, perhaps times a factor.
RIGHT_SIDE = re.compile(r"(?P<number>[0-9.]+(e-?[0-9]+)?)$|((?P<factor>[0-9.]+)\*)?(?P<label>.+)")
BAND_METRIC = re.compile("(share_inside|share_above|stays_above_from)_(pose|position|heading)$")
DIMENSIONS = {"pose": 3, "position": 2, "heading": 1}


class PrintedError(Exception):
    """A file is missing, damaged or inconsistent. The text is "file: problem: remedy"."""


# ---- Numbers in the paper


def fields_of(words, required, optional):
    """The fields key=value as a dictionary."""
    fields = {}
    for word in words:
        key, equals, value = word.partition("=")
        if not equals or key not in required + optional or key in fields or not value:
            raise ValueError(f"'{word}' is not understood: write {'=... '.join(required)}=..., and "
                             f"of {', '.join(optional) or 'nothing else'} what applies, each once")
        fields[key] = value
    absent = [key for key in required if key not in fields]
    if absent:
        raise ValueError(f"{absent[0]}= is missing: add it")
    return fields


def count_in(text):
    count = int(text)
    if count < 1:
        raise ValueError(f"runs = {text} (a whole number above 0 is needed): correct it")
    return count


def value_of(text):
    value = fields_of(shlex.split(text), ["cell", "metric", "printed"],
                      ["relative_to", "runs", "note"])
    value["number"] = float(value["printed"])
    if not math.isfinite(value["number"]):
        raise ValueError(f"printed={value['printed']} is no finite number: write it as the paper "
                         "does")
    if "runs" in value:
        value["runs"] = count_in(value["runs"])
    decimals = re.sub("[eE].*", "", value["printed"]).partition(".")[2]
    value["rounding"] = 0.5 * 10.0 ** -len(decimals)
    if "relative_to" in value and BAND_METRIC.match(value["metric"]):
        raise ValueError(f"relative_to= has no meaning for {value['metric']}: remove it")
    return value


def claim_of(text):
    words = shlex.split(text)
    if len(words) not in (4, 5) or words[2] not in ("<", ">", "~") or (
            len(words) == 5 and not words[4].startswith("note=")):
        raise ValueError("write claim = METRIC LABEL < LABEL [note=\"...\"] (or >, ~; a number, or "
                         "FACTOR*LABEL, may stand on the right)")
    right = RIGHT_SIDE.match(words[3])
    of_bands = BAND_METRIC.match(words[0])
    if of_bands and (words[2] == "~" or right["number"] or right["factor"]):
        raise ValueError(f"this has no meaning for {words[0]}: claim LABEL < or > LABEL")
    claim = {"metric": words[0], "left": words[1], "relation": words[2], "against": words[3],
             "note": words[4].removeprefix("note=") if len(words) == 5 else ""}
    if right["number"]:
        return claim | {"number": float(right["number"])}
    return claim | {"right": right["label"], "factor": float(right["factor"] or 1.0)}


def band_of(text):
    words = text.split()
    if len(words) != 3 or words[0] not in DIMENSIONS or not float(words[1]) < float(words[2]):
        raise ValueError("write band = pose LOWER UPPER (or position, heading)")
    return words[0], (float(words[1]), float(words[2]))


def read_statements(path, parsers, repeated):
    """The statements KEY = TEXT of a file: {key: parsed}, of the keys in `repeated` a list, else
    None where there is no statement. `parsers` {key: parse(text)} may raise ValueError. Raises
    PrintedError."""
    statements = {key: [] if key in repeated else None for key in parsers}
    try:
        with open(path, encoding="utf-8") as file:
            lines = file.read().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise PrintedError(f"{path}: cannot be read ({error}): check the path") from None
    for number, line in enumerate(lines, 1):
        if not line.strip() or line.startswith("#"):
            continue
        key, equals, text = (part.strip() for part in line.partition("="))
        try:
            if not equals or key not in parsers or not text:
                raise ValueError(f"'{line[:60]}' is not understood: write KEY = TEXT with one of "
                                 f"{', '.join(parsers)}")
            parsed = parsers[key](text)
            if key in repeated:
                statements[key].append(parsed)
            elif statements[key] is not None:
                raise ValueError(f"{key} is given twice: remove one of the two")
            else:
                statements[key] = parsed
        except ValueError as error:
            raise PrintedError(f"{path}:{number}: {error}") from None
    return statements


def read_printed(path):
    """The statements of a .printed file as a dictionary by key. Raises PrintedError."""
    printed = read_statements(
        path, {"source": str, "runs": count_in, "baseline": str, "substitute": str,
               "band": band_of,
               "value": value_of, "claim": claim_of, "assume": str},
        ("band", "value", "claim", "assume"))
    bands = dict(printed["band"])
    if len(bands) < len(printed["band"]):
        raise PrintedError(f"{path}: a band is given twice: remove one of the two")
    return printed | {"band": bands, "source": printed["source"] or ""}


# ---- Measured numbers


def table_of(folder, name):
    """The rows of a CSV file of `analyze` as dictionaries, with names of columns without units."""
    path = os.path.join(folder, name)
    try:
        with open(path, encoding="utf-8", newline="") as file:
            rows = list(csv.reader(file, strict=True))
        names = [heading.split(" [")[0] for heading in rows[0]]
        if any(len(row) != len(names) for row in rows):
            raise ValueError("a row is incomplete")
    except (OSError, ValueError, IndexError, csv.Error) as error:
        raise PrintedError(f"{path}: cannot be read ({error}): write the folder again with "
                           "montecarta analyze FILE.h5 --csv FOLDER --force") from None
    return [dict(zip(names, row)) for row in rows[1:]]


def columns_of(metric):
    """The columns of runs.csv that a metric is made of: none of a band, two of a difference."""
    if BAND_METRIC.match(metric):
        return []
    return metric.removeprefix(VARIANCE_OF).split("-", 1)


class Measured:
    """The tables of a folder that `analyze --csv` wrote."""

    def __init__(self, folder):
        self.folder = folder
        self.labels = [row["cell"] for row in table_of(folder, "cells.csv")]
        self.runs = {label: {} for label in self.labels}
        for row in table_of(folder, "runs.csv"):
            self.runs[row["cell"]][int(row["run"])] = row

    def check(self, metric, *labels):
        for label in labels:
            if label not in self.labels:
                raise PrintedError(f"{self.folder}: there is no cell '{label}': correct the label "
                                   f"(there are {', '.join(self.labels)})")
        known = [name for rows in self.runs.values() for row in rows.values() for name in row]
        for column in columns_of(metric):
            if known and column not in known:
                raise PrintedError(f"{self.folder}/runs.csv: there is no column '{column}': "
                                   "correct the metric")

    def scores(self, label, metric):
        """The metric {run} of the complete runs; NaN if a run has no such number."""
        first, *subtracted = columns_of(metric)
        return {run: float(row[first] or "nan") - sum(float(row[s] or "nan") for s in subtracted)
                for run, row in self.runs[label].items()}

    def by_band(self, label, metric, printed_bands):
        """A band metric, i.e. a share of scans or a time [s], of the average NEES of all runs."""
        kind, block = BAND_METRIC.match(metric).groups()
        tests = [row for row in table_of(self.folder, "consistency.csv")
                 if row["cell"] == label and row["error"] == block]
        if not tests:
            return math.nan
        series = table_of(self.folder, f"series_{label}.csv")
        anees = np.array([float(row[f"anees_{block}_{tests[0]['covariance']}"]) for row in series])
        times = np.array([float(row["time"]) for row in series])
        n, d = len(self.runs[label]), DIMENSIONS[block]
        expected = stats.chi2.interval(LEVEL, n * d)
        lower, upper = printed_bands.get(block, (expected[0] / n, expected[1] / n))
        judged = np.isfinite(anees)
        anees, times = anees[judged], times[judged]
        if not len(anees):
            return math.nan
        if kind == "share_inside":
            return float(np.mean((anees >= lower) & (anees <= upper)))
        if kind == "share_above":
            return float(np.mean(anees > upper))
        below = np.flatnonzero(anees <= upper)
        first = below[-1] + 1 if len(below) else 0
        return float(times[first]) if first < len(times) else math.inf


# ---- The comparison


def distance_text(measured, number):
    if math.isinf(measured):
        return "not reproduced: never"
    factor = measured / number if number else math.nan
    if not factor > 0:
        return "differs"
    how = f"{factor:.2g} times as large" if factor >= 1 else f"{1 / factor:.2g} times smaller"
    far = factor > REPRODUCED_WITHIN or factor < 1 / REPRODUCED_WITHIN
    return f"{'not reproduced' if far else 'differs'}: {how}"


def interval_of(values):
    """Student's interval of the mean; None if there are fewer than two values."""
    if len(values) < 2:
        return None
    half = stats.t.ppf(0.5 + LEVEL / 2, len(values) - 1) * stats.sem(values)
    return np.mean(values) - half, np.mean(values) + half


def paired(measured, left, right, metric):
    """The metric {run, (left, right)} of the runs that both cells completed. Of a variance these
    are squared deviations, whose mean it is."""
    l, r = measured.scores(left, metric), measured.scores(right, metric)
    pairs = np.array([(l[run], r[run]) for run in sorted(l.keys() & r.keys())]).reshape(-1, 2)
    pairs = pairs[np.isfinite(pairs).all(1)]
    if not metric.startswith(VARIANCE_OF) or not len(pairs):
        return pairs
    return (pairs - pairs.mean(0)) ** 2 * (len(pairs) / max(len(pairs) - 1, 1))


def sides(measured, claim):
    """The left and the right side of a claim {run, (left, right)}."""
    pairs = paired(measured, claim["left"], claim.get("right", claim["left"]), claim["metric"])
    if "number" in claim:
        pairs[:, 1] = claim["number"]
    else:
        pairs[:, 1] *= claim["factor"]
    return pairs


def judge_value(value, printed, measured, batches):
    """Compares a printed number: (measured mean, its interval or None, verdict)."""
    number, rounding = value["number"], value["rounding"]
    cell, metric = value["cell"], value["metric"]
    if BAND_METRIC.match(metric):
        numbers = np.sort([b.by_band(cell, metric, printed["band"]) for b in batches or [measured]])
        if np.isnan(numbers).any():
            return math.nan, None, "not measured"
        cut = int(0.5 * (1 - LEVEL) * len(numbers))
        lowest, median, highest = numbers[cut], np.median(numbers), numbers[-1 - cut]
        agrees = lowest - rounding <= number <= highest + rounding
        return median, (lowest, highest), "agrees" if agrees else distance_text(median, number)
    paper_runs = value.get("runs", printed["runs"]) or 1
    if "relative_to" in value:
        pairs = paired(measured, cell, value["relative_to"], metric)
        if not len(pairs):
            return math.nan, None, "not measured"
        base = pairs[:, 1].mean()
        mean = pairs[:, 0].mean() / base
        sample = mean + (pairs[:, 0] - mean * pairs[:, 1]) / base  # linearised ratio of each run
    else:
        sample = np.array(list(measured.scores(cell, metric).values()))
        sample = sample[np.isfinite(sample)]
        if not len(sample):
            return math.nan, None, "not measured"
        mean = sample.mean()
    interval = interval_of(sample)
    off = abs(mean - number)
    if off <= rounding:
        return mean, interval, "agrees"
    if interval is None:
        return mean, None, "differs (one run)" if off > 0.2 * abs(number) else "agrees within 20 %"
    if paper_runs == 1 and "relative_to" not in value:  # it must lie among our runs
        beyond = min((sample <= number + rounding).sum(), (sample >= number - rounding).sum())
        if beyond < max(1, int(0.5 * (1 - LEVEL) * len(sample))):
            return mean, interval, distance_text(mean, number)
    reach = (stats.t.ppf(0.5 + LEVEL / 2, len(sample) - 1) * sample.std(ddof=1)
             * math.sqrt(1 / len(sample) + 1 / paper_runs))
    return mean, interval, "agrees" if off <= rounding + reach else distance_text(mean, number)


def another_world(value, printed, measured, batches):
    """The verdict if the world is a substitute, or if the baseline is off too far in the same
    metric; else None."""
    if printed["substitute"]:
        return f"another world: {printed['substitute']} in place of the paper's"
    if value["cell"] == printed["baseline"]:
        return None
    for other in printed["value"]:
        if (other["cell"], other["metric"]) == (printed["baseline"], value["metric"]):
            mean = judge_value(other, printed, measured, batches)[0]
            verdict = distance_text(mean, other["number"])
            if verdict.startswith("not reproduced"):
                return f"another world: {other['cell']}{verdict.removeprefix('not reproduced')}"
    return None


def judge_claim(claim, printed, measured, batches):
    """Tests a claim: (left minus right, its interval or None, verdict)."""
    relation = claim["relation"]
    sign = -1.0 if relation == "<" else 1.0
    if BAND_METRIC.match(claim["metric"]):
        pairs = [[b.by_band(claim[side], claim["metric"], printed["band"])
                  for side in ("left", "right")]
                 for b in batches or [measured]]
        if np.isnan(pairs).any():
            return math.nan, None, "not measured"
        differences = np.array([0.0 if l == r else l - r for l, r in pairs])
        holds, fails = (sign * differences > 0).sum(), (sign * differences < 0).sum()
        n = len(differences)
        if n == 1:
            verdict = "holds" if holds else "contradicted" if fails else "undecided"
            return differences[0], None, f"{verdict}, over all runs"
        verdict = (f"holds in {n} of {n} batches" if holds == n else
                   f"contradicted in {n} of {n} batches" if fails == n else
                   f"undecided: holds in {holds} of {n} batches, contradicted in {fails}")
        return np.median(differences), None, verdict
    pairs = sides(measured, claim)
    if not len(pairs):
        return math.nan, None, "not measured"
    differences = pairs[:, 0] - pairs[:, 1]
    interval = interval_of(differences)
    lower, upper = interval or (differences[0], differences[0])
    alone = "" if interval else ", of one run"
    if relation == "~":
        near = ALIKE_WITHIN * np.abs(pairs.mean(0)).mean()
        name = ("holds" if -near < lower and upper < near else
                "contradicted" if lower > near or upper < -near else "undecided")
    elif lower <= 0 <= upper:
        name = "undecided"
    else:
        name = "holds" if sign * lower > 0 else "contradicted"
    return differences.mean(), interval, name + alone


# ---- Markdown


def name_of_value(value):
    """What the tables call the metric of a printed number."""
    return value["metric"] + (f", relative to {value['relative_to']}" if "relative_to" in value
                              else "")


def name_of_claim(claim):
    return f"{claim['metric']}: {claim['left']} {claim['relation']} {claim['against']}"


def number_text(number):
    return "-" if math.isnan(number) else "never" if math.isinf(number) else f"{number:.4g}"


def interval_text(interval):
    return "-" if interval is None else f"[{number_text(interval[0])}, {number_text(interval[1])}]"


def escaped(text):
    """Text as Markdown that shows it as it is."""
    return re.sub(r"([\\|_~<>\[\]])", r"\\\1", text)


def print_table(headings, rows):
    if not rows:
        return
    print("\n| " + " | ".join(headings) + " |\n|" + "---|" * len(headings))
    for row in rows:
        print("| " + " | ".join(map(escaped, row)) + " |")


def judged(printed, measured, batches):
    """All statements with what was measured: (values, claims), each a list of (statement, (mean or
    difference, its interval or None, verdict)). Raises PrintedError."""
    for value in printed["value"]:
        measured.check(value["metric"], value["cell"], value.get("relative_to", value["cell"]))
    for claim in printed["claim"]:
        measured.check(claim["metric"], claim["left"], claim.get("right", claim["left"]))
    values = []
    for value in printed["value"]:
        mean, interval, verdict = judge_value(value, printed, measured, batches)
        values.append((value, (mean, interval,
                               another_world(value, printed, measured, batches) or verdict)))
    return values, [(claim, judge_claim(claim, printed, measured, batches))
                    for claim in printed["claim"]]


# ---- Three sentences


def counted(number, noun):
    return f"{number} {noun}" + ("" if number == 1 else "s")


def metric_in_words(metric):
    """A metric in a sentence, before "of CELL": "position RMSE", "CPU time"."""
    words = metric.replace("_", " ").replace("-", " minus ")
    for name, meaning in ((r"stays above from (\w+)", r"time to lasting inconsistency of the \1"),
                          (r"nees (position|heading|pose)", r"NEES of the \1"),
                          ("cpu seconds", "CPU time"),
                          ("reference rms", "RMS distance from the reference")):
        words = re.sub(rf"\b{name}\b", meaning, words)
    return re.sub(r"\b(rmse|rms|nees|nis|ess)\b", lambda word: word[0].upper(), words)


def claim_in_words(claim):
    relation = {"<": "is less than", ">": "is greater than",
                "~": "differs by less than 10 % from"}[claim["relation"]]
    right = claim["against"]
    if "right" in claim:
        times = "" if claim["factor"] == 1.0 else f"{claim['factor']:g} times "
        right = f"{times}that of {claim['right']}"
    where = f" ({claim['note']})" if claim["note"] else ""
    return f"the {metric_in_words(claim['metric'])} of {claim['left']} {relation} {right}{where}"


def tally(judgements, *beginnings):
    """The number of verdicts that begin so."""
    return sum(verdict.startswith(beginnings) for _, (_, _, verdict) in judgements)


def said_by_paper(source, values, claims):
    numbers = f"prints {counted(len(values), 'number')} that can be compared"
    if not claims:
        return f"{source}, {numbers}."
    more = [numbers] if values else []
    if len(claims) > 1:
        more.insert(0, f"makes {counted(len(claims) - 1, 'more claim')} of this kind")
    return (f"{source}, says that {claim_in_words(claims[0][0])}"
            + ", ".join(["", *more[:-1], *(f"and {each}" for each in more[-1:])]) + ".")


def answer_in_words(judgement):
    """The verdict on the first claim, with the difference that was measured."""
    _, (difference, interval, verdict) = judgement
    measured = number_text(difference) + ("" if interval is None else f" {interval_text(interval)}")
    answer = {"holds": "holds", "contradicted": "is contradicted",
              "undecided": "is undecided"}.get(re.split("[ ,:]", verdict)[0],
                                               "could not be measured")
    return f"the first claim {answer} (the left side minus the right side is {measured})"


def found_by_us(values, claims):
    found = [answer_in_words(claims[0])] if claims else []
    if len(claims) > 1:
        counts = [tally(claims, verdict) for verdict in ("holds", "contradicted", "undecided")]
        verbs = ["holds" if counts[0] == 1 else "hold",
                 *("is" if count == 1 else "are" for count in counts[1:])]
        found.append(f"of all {len(claims)} claims, {counts[0]} {verbs[0]}, "
                     f"{counts[1]} {verbs[1]} contradicted and {counts[2]} {verbs[2]} undecided")
    if values:
        agreeing = tally(values, "agrees")
        found.append(f"of {counted(len(values), 'printed number')}, "
                     f"{agreeing} agree{'s' if agreeing == 1 else ''} with ours")
    return "We find: " + "; ".join(found) + "."


def how_sure(printed, measured, values):
    runs = sorted(len(rows) for rows in measured.runs.values())
    ours = f"{runs[0]}" if runs[0] == runs[-1] else f"{runs[0]} to {runs[-1]}"
    paper = (f"the paper has {printed['runs']}" if printed["runs"] else
             "the paper does not say of how many its numbers are")
    sentence = (f"How sure: each cell has {ours} complete runs ({paper}), cells are compared run "
                f"by run, and intervals are at {LEVEL * 100:.0f} %")
    if printed["substitute"]:
        return (sentence + f"; {printed['substitute']} stands in place of the paper's world, so "
                "that the paper's numbers are not compared with ours.")
    for value, (mean, _, verdict) in values:
        if value["cell"] == printed["baseline"] and verdict.startswith("not reproduced"):
            return (sentence + f"; but the {metric_in_words(value['metric'])} of {value['cell']} "
                    f"itself is {verdict.partition(': ')[2]}, so the paper's world must have been "
                    "another, and only orders of filters can be compared.")
    return sentence + "."


def lead(printed, measured, values, claims):
    """Three sentences as Markdown: what the paper says, what we find, how sure that is."""
    of_paper = [[each for each in judgements if not each[0].get("note", "").startswith(OURS)]
                for judgements in ([] if printed["substitute"] else values, claims)]
    sentences = (said_by_paper(printed["source"], *of_paper), found_by_us(*of_paper),
                 how_sure(printed, measured, of_paper[0]))
    return textwrap.fill(" ".join(map(escaped, sentences)), 100, break_long_words=False,
                         break_on_hyphens=False)


def compare(printed, measured, batches):
    """Prints the whole comparison, and returns its three sentences."""
    values, claims = judged(printed, measured, batches)
    print("## Printed and measured\n\n" + printed["source"])
    print_table(["cell", "metric", "paper printed", "we measure", "95 % interval", "verdict",
                 "where"],
                [[value["cell"], name_of_value(value), value["printed"], number_text(mean),
                  interval_text(interval), verdict, value.get("note", "")]
                 for value, (mean, interval, verdict) in values])
    print_table(["paper says", "we measure: left - right", "95 % interval", "verdict", "where"],
                [[name_of_claim(claim), number_text(difference), interval_text(interval), verdict,
                  claim["note"]] for claim, (difference, interval, verdict) in claims])
    of = (f"are means over {printed['runs']} runs" if printed["runs"] else
          "are taken as those of one run, since it does not say of how many they are")
    print(f"\nThe paper's numbers {of}. A printed "
          "number agrees if the mean of so many of our runs would lie as far from our mean with "
          "a probability of 5 % or more, or if it rounds to the printed digits. It is not "
          f"reproduced if it is off by more than a factor of {REPRODUCED_WITHIN:g}. A claim holds "
          "or is contradicted if the whole 95 % interval of the difference, run by run on the "
          "same worlds and noise, lies on one side; ~ claims a difference below 10 %.")
    if any(BAND_METRIC.match(each["metric"]) for each in printed["value"] + printed["claim"]):
        print(f"\nNumbers from a band of the average NEES are those of {len(batches)} batches with "
              "as many runs as the paper had: their median, and the range in which 95 % of them "
              "lie. A printed number agrees if it lies in that range, and a claim holds if it "
              "holds in all batches." if len(batches) > 1 else
              "\nNumbers from a band of the average NEES are those of all runs together.")
    if printed["assume"]:
        print("\nWhat the paper leaves open, and what is assumed:\n")
        for each in printed["assume"]:
            print("- " + re.sub(r"([\\|_~<>])", r"\\\1", each))
    return lead(printed, measured, values, claims)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("printed", help="the .printed file")
    parser.add_argument("folder", help="folder that analyze --csv wrote for the whole study")
    parser.add_argument("batch", nargs="*", help="folder that it wrote for a batch of runs")
    parser.add_argument("--lead", metavar="FILE", help="file for three sentences, to be replaced")
    arguments = parser.parse_args()
    try:
        sentences = compare(read_printed(arguments.printed), Measured(arguments.folder),
                            [Measured(batch) for batch in arguments.batch])
        if arguments.lead:
            with open(arguments.lead, "w", encoding="utf-8") as file:
                file.write(sentences + "\n")
    except OSError as error:
        print(f"printed.py: {arguments.lead}: cannot be written ({error}): choose another file",
              file=sys.stderr)
        sys.exit(2)
    except PrintedError as error:
        print(f"printed.py: {error}", file=sys.stderr)
        sys.exit(2)
