"""What ``import ddlib`` gives: names that the Tab key finds, without PyTorch until it is needed."""

import subprocess
import sys
import textwrap

import ddlib


def test_the_example_of_the_help_runs(capsys):
    example = ddlib.__doc__.split("::\n\n", 1)[1].split("\n\nThe names", 1)[0]
    exec(textwrap.dedent(example), names := {})
    printed = capsys.readouterr().out.split()
    assert len(printed) == 4 and names["parts"].even.shape == (4, 10, 2, 11)


def test_torch_waits_until_it_is_needed():
    code = "import sys, ddlib; ddlib.STATE_FEEDBACK.record(); print('torch' in sys.modules)"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "False"
