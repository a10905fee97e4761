# SPDX-License-Identifier: BSD-3-Clause
"""Examples of documents, which tests execute."""
import os
import re
import textwrap

DOCUMENT = os.path.join(os.path.dirname(os.path.abspath(__file__)),
                        "../../experiments/JUDGING_ESTIMATES.md")


def example(introduction):
    """The indented block behind the paragraph that ends with these words."""
    with open(DOCUMENT, encoding="utf-8") as file:
        found = re.findall(re.escape(introduction) + r"\n\n((?:    .*\n|\n)+)", file.read())
    if len(found) != 1:
        raise LookupError(f"{len(found)} examples are introduced by {introduction!r}")
    return textwrap.dedent(found[0])
