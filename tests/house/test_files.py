"""Files: whole or not there, whatever happens while they are written."""

import pytest

from ddlib import _files
from ddlib._files import write_whole


def test_a_file_is_written_with_its_folder_and_replaced(tmp_path):
    path = tmp_path / "Übung (1)" / "a b.svg"
    for text in ("first, °", "second"):
        write_whole(path, text)
        assert path.read_text(encoding="utf-8") == text
    write_whole(str(path), b"\x00\xff")
    assert path.read_bytes() == b"\x00\xff"
    assert [p.name for p in path.parent.iterdir()] == ["a b.svg"]


@pytest.mark.parametrize("kind", [OSError, KeyboardInterrupt])
def test_what_fails_half_way_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch, kind):
    path = tmp_path / "kept.txt"
    write_whole(path, "old")

    def fail(*_):
        raise kind

    monkeypatch.setattr(_files.os, "replace", fail)
    with pytest.raises(kind):
        write_whole(path, "new" * 10**5)
    assert [p.name for p in tmp_path.iterdir()] == ["kept.txt"]
    assert path.read_text() == "old"
