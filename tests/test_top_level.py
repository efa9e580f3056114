"""What ``import ddlib`` gives: the example of its help runs."""

import textwrap

import ddlib


def test_the_example_of_the_help_runs(capsys):
    example = ddlib.__doc__.split("::\n\n", 1)[1].split("\n\nThe names", 1)[0]
    exec(textwrap.dedent(example), names := {})
    printed = capsys.readouterr().out.split()
    assert len(printed) == 4 and names["parts"].even.shape == (4, 10, 2, 11)
