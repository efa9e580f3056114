"""What `make check` prints for reviews: every file counts once, in its own room."""

import sizes


def test_rooms_count_their_own_files_and_names(tmp_path):
    texts = {
        "ddlib/arm.py": "G, _G = 9.81, 0\n\ndef turn(x):\n    y = x\n\nclass _Own:\n    z = 1\n",
        "ddlib/_inside.py": "def hidden(): ...\n",
        "ddlib/widgets/pad.py": "A: int = 1\n",
        "ddlib/widgets/static/pad.js": "let a;\nlet b;\n",
        "book/_ext/build.py": "NAME = 1\n",
    }
    for name, text in texts.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    found = {room: told for room, *told in sizes.sizes(tmp_path)}
    assert found["ddlib"] == [8, 0, 2, "arm.py, 7"]
    assert found["ddlib/widgets"] == [1, 2, 1, "pad.py, 1"]
    assert found["book/_ext"] == [1, 0, 0, "build.py, 1"]
    assert found["tests"] == [0, 0, 0, ""]


def test_the_table_is_printed(capsys):
    sizes.main()
    told = capsys.readouterr().out
    assert all(f"\n{room} " in told for room in sizes.ROOMS)
