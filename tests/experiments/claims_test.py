# SPDX-License-Identifier: BSD-3-Clause
"""The ledger of claims, on pages of our own making, and that of the repository."""
import contextlib
import io
import os
import sys
import tempfile
import unittest

SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../..")
sys.path.insert(0, os.path.join(SOURCE, "experiments"))
try:
    import claims
    import printed
except (ImportError, SystemExit):
    print("skipped: python3-scipy is not installed (bash .ci/install-packages convert)")
    sys.exit(77)

STUDY = """[scenario]
speed = 3  # m/s
[cells]
cell = one  label=a  particles=30
cell = two  particles=10,20
"""
PRINTED = """runs = 20
band = position 1.3 2.79
value = cell=a metric=position_rmse printed=4.0 note="Table 1"
claim = position_rmse a < two_m10 note="Fig. 1"
claim = nees a < two_m10 note="Fig. 2"
claim = nees a < two_m20 note="not in the paper: why"
"""
CLAIMS = """title = A paper
page = s
compare = "position RMSE" a < two_m10 page=s where="1" says="better"
compare = "raw RMS" a > 10 page=s where="2" says="far"
settings = speed=3 a.particles=30 scan_rate=5 study=s where="3"
settings = speed=3 a.particles=3 study=s where="3"
open = where="4" says="fast" study=s needs="a clock"
never = where="5" says="nice" because="it has no unit"
headline = s "position_rmse: a < two_m10" says="a is better"
"""
PAGE = r"""# A study

- study `s`, seed 1: 20 of 20 runs, 10 scans each

| cell | position RMSE \[m\] | ESS |
|---|---:|---:|
| a | 5.0 \[4.0, 6.0\] | 9 |
| two\_m10 | 3.0 \[2.0, 3.9\] | 9 |

| cell | reference | raw RMS \[m\] |
|---|---|---:|
| a | gps | 12.0 +- 1.0 |
| a | all | 1.0 +- 1.0 |

| cell | metric | paper printed | we measure | 95 % interval | verdict | where |
|---|---|---|---|---|---|---|
| a | position\_rmse | 4.0 | 5 | \[4, 6\] | not reproduced: 3 times as large | Table 1 |

| paper says | we measure: left - right | 95 % interval | verdict | where |
|---|---|---|---|---|
| position\_rmse: a \< two\_m10 | 2 | \[1, 3\] | contradicted | Fig. 1 |
| nees: a \< two\_m20 | -2 | \[-3, -1\] | holds | not in the paper: why |

Study: [s.ini](../studies/s.ini). Again
"""
METRICS = '{"position_rmse", "m", "x"}, {"nees", "1", "x"}'
DEFAULTS = 'scenario.number("scan_rate", "Hz", "5", 1, 2, "scans")'
FILES = {"studies/s.ini": STUDY, "studies/s.printed": PRINTED, "studies/paper.claims": CLAIMS,
         "results/s.md": PAGE, "../analysis/metrics/errors.cpp": METRICS,
         "study/setting_table.cpp": DEFAULTS,
         "../filters/one/one.cpp": 'number_parameter("h", "1.7"), count_parameter(\n"F",\n "1")',
         "../filters/one/two.cpp": 'number_parameter("h", "1.7"), count_parameter("F", "2")'}


def text_of(ledger):
    with contextlib.redirect_stdout(io.StringIO()) as out:
        claims.print_ledger(ledger)
    return out.getvalue()


class Claims(unittest.TestCase):
    def ledger(self, **changes):
        """The ledger of FILES, in which `changes` {end of a name: (old, new)} replace text."""
        with tempfile.TemporaryDirectory() as folder:
            for name, text in FILES.items():
                for end, (old, new) in changes.items():
                    if name.endswith("." + end):
                        self.assertIn(old, text)
                        text = text.replace(old, new)
                path = os.path.join(folder, "experiments", name)
                os.makedirs(os.path.dirname(path), exist_ok=True)
                with open(path, "w", encoding="utf-8") as file:
                    file.write(text)
            return claims.Ledger(os.path.join(folder, "experiments"))

    def answers(self, **changes):
        return {row["claim"]: row["answer"] for row in self.ledger(**changes).papers[0]["rows"]}

    def test_answers_are_those_of_the_page(self):
        self.assertEqual(self.answers(), {
            "a: position rmse 4.0": "contradicted", "position rmse: a < two_m10": "contradicted",
            "nees: a < two_m10": "not measured yet", "nees: a < two_m20": "confirmed",
            "band of the NEES of the position: [1.3, 2.79]": "contradicted",
            "better; position RMSE: a < two_m10": "contradicted", "far; raw RMS: a > 10":
            "undecided", "fast": "not measured yet", "nice": "cannot be measured"})
        # The standard error of 20 runs is 1.0, so the interval is 12.0 -+ 2.09.
        for old, new, answer in (("12.0 +-", "12.2 +-", "confirmed"),
                                 ("12.0 +-", "7.0 +-", "contradicted")):
            self.assertEqual(self.answers(md=(old, new))["far; raw RMS: a > 10"], answer)
        for verdict, answer in (("holds in 2 of 2 batches", "confirmed"), ("undecided: x",
                                "undecided"), ("another world: b", "undecided")):
            changed = self.answers(md=("| contradicted |", f"| {verdict} |"))
            self.assertEqual(changed["position rmse: a < two_m10"], answer)
        self.assertEqual(self.answers(printed=("1.3 2.79", "1.22 2.97"))
                         ["band of the NEES of the position: [1.22, 2.97]"], "confirmed")

    def test_first_sentences_count_the_claims_of_the_paper(self):
        ledger = self.ledger()
        self.assertEqual([ledger.count(answer) for answer in claims.ORDER], [4, 0, 1, 2, 1])
        self.assertIn("[that a is better](s.md)", text_of(ledger).replace("\n", " "))
        agreed = self.ledger(md=("| contradicted |", "| holds |"))
        self.assertNotIn("that a is better", text_of(agreed))

    def test_settings_are_those_of_the_study_or_its_defaults(self):
        rows = self.ledger().papers[0]["set"]
        self.assertEqual([row["answer"] for row in rows], ["as printed", "not as printed"])
        self.assertEqual(rows[1]["measured"], "a.particles = 30")

    def test_options_of_a_filter_have_the_default_of_its_source(self):
        line = "settings = two_m10.h=1.7 runs=20 study=s where=3\n"
        rows = self.ledger(claims=("headline", line + "headline")).papers[0]["set"]
        self.assertEqual(rows[2]["answer"], "as printed")
        rows = self.ledger(claims=("headline", line.replace("20", "30").replace("1.7", "3")
                                   + "headline")).papers[0]["set"]
        self.assertEqual(rows[2]["measured"], "two_m10.h = 1.7, runs = 20")
        for other in ("F", "g"):  # two filters have different ones, and none has any
            with self.assertRaisesRegex(printed.PrintedError, "there is no setting 'a." + other):
                self.ledger(claims=("a.particles=3 ", f"a.{other}=1 "))

    def test_refuses_a_claim_about_what_does_not_exist(self):
        for end, old, new, piece in (
                ("claims", "page = s", "page = t", "t.md: the page cannot be read"),
                ("claims", "page=s where=\"1\"", "page=t where=\"1\"", "t.md: the page cannot"),
                ("claims", "study=s needs", "study=t needs", "t.ini: the study cannot be read"),
                ("claims", "\" a < two_m10", "\" z < two_m10", "'position RMSE' of cell 'z'"),
                ("claims", "position RMSE", "sharpness", "no table has the column 'sharpness'"),
                ("claims", "position RMSE", "ESS", "'ESS' of a has no interval"),
                ("claims", "a.particles=3 ", "z.particles=3 ", "there is no cell 'z'"),
                ("claims", "scan_rate=5", "scan_rat=5", "there is no setting 'scan_rat'"),
                ("claims", "a < two_m10\" says", "a < z\" says", "no comparison"),
                ("printed", "nees a < two_m10", "nees a < two", "there is no cell 'two'"),
                ("printed", "nees a < two_m10", "sharp a < two_m10", "there is no metric 'sharp'"),
                ("printed", "nees a < two_m10", "nees a < two_m20", "is given twice")):
            with self.assertRaisesRegex(printed.PrintedError, piece):
                self.ledger(**{end: (old, new)})

    def test_compares_with_a_cell_of_another_page(self):
        line = 'compare = "wrong" a < 1.5*a@s page=s where="6" says="alike"\n'
        table = "| cell | wrong |\n|---|---:|\n| a | {} |\n\nStudy:"
        for wrong, answer in (("3.0 \\[2.5, 3.5\\]", "confirmed"),
                               ("3.0 \\[2.0, 4.0\\]", "undecided")):
            answers = self.answers(claims=("headline", line + "headline"),
                                   md=("Study:", table.format(wrong)))
            self.assertEqual(answers["alike; wrong: a < 1.5*a@s"], answer)

    def test_takes_a_number_without_an_interval_from_a_column(self):
        line = 'within = "{}" a {} page=s where="6" says="many"\n'
        for ends, answer in (("9 10", "confirmed"), ("9.1 10", "contradicted"),
                             ("2 8.9", "contradicted"), ("two_m10 inf", "confirmed"),
                             ("3 two_m10", "confirmed"), ("0 0.5*two_m10", "contradicted"),
                             ("0 2*two_m10", "confirmed")):
            answers = self.answers(claims=("headline", line.format("ESS", ends) + "headline"))
            self.assertEqual(answers[f"many; ESS: a from {ends.replace(' ', ' to ')}"], answer)
        sweep = "| filter | ESS |\n|---|---:|\n| a | 3 |\n\n| cell | position"
        answers = self.answers(claims=("headline", line.format("ESS", "9 9") + "headline"),
                               md=("| cell | position", sweep))
        self.assertEqual(answers["many; ESS: a from 9 to 9"], "confirmed")
        for column, piece in (("reference", "'reference' of a is no number"),
                              ("sharpness", "no table has the column 'sharpness'")):
            with self.assertRaisesRegex(printed.PrintedError, piece):
                self.answers(claims=("headline", line.format(column, "1 2") + "headline"))

    def test_takes_a_number_from_a_sentence(self):
        line = 'stated = "is of ([0-9]+) s" 1500 2100 page=s where="6" says="long"\n'
        for sentence, answer in (("The drive\nis of 1549 s.", "confirmed"),
                                 ("The drive is of 149 s.", "contradicted")):
            answers = self.answers(claims=("headline", line + "headline"),
                                   md=("Study:", sentence + "\n\nStudy:"))
            self.assertEqual(answers["long"], answer)
        with self.assertRaisesRegex(printed.PrintedError, "no sentence has 'is of"):
            self.answers(claims=("headline", line + "headline"))

    def test_refuses_a_comparison_on_a_page_that_is_no_claim(self):
        for end, old, piece in (
                ("printed", "claim = position_rmse a < two_m10 note=\"Fig. 1\"\n", "is no claim"),
                ("printed", "printed=4.0", "is no claim"),
                ("claims", "page = s\n", "no .claims file names this page")):
            new = "printed=4.1" if old == "printed=4.0" else ""
            with self.assertRaisesRegex(printed.PrintedError, piece):
                self.ledger(**{end: (old, new)})

    def test_refuses_a_line_that_it_does_not_understand(self):
        for line in ("quote = 3", "title = again", "compare = \"x\" a ~ b page=s where=1 says=x",
                     "compare = \"x\" a < b page=s", "stated = x page=s",
                     "within = \"x\" a 1 page=s where=1 says=x", "within = \"x\" a 1 2 page=s",
                     "settings = study=s where=1", "open = where=1",
                     "never = where=1 says=x needs=y", "headline = s says=x"):
            with self.assertRaisesRegex(printed.PrintedError, "paper.claims:2: "):
                self.ledger(claims=("title = A paper\n", f"title = A paper\n{line}\n"))

    def test_the_ledger_of_the_repository_is_what_the_program_writes(self):
        folder = os.path.join(SOURCE, "experiments")
        with open(os.path.join(folder, "results/claims.md"), encoding="utf-8") as file:
            self.assertEqual(file.read(), text_of(claims.Ledger(folder)), "python3 "
                             "experiments/claims.py > experiments/results/claims.md")


if __name__ == "__main__":
    unittest.main()
