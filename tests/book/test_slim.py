"""What the build takes out of the pages and their styles."""

import pytest
import slim


def test_no_other_address_than_data_is_opened(tmp_path):
    for address in ("http://localhost/x.svg", "file:///etc/hostname", "x.svg"):
        with pytest.raises(ValueError, match=r"^address must begin with data:"):
            slim.keep(tmp_path / "_images", "../", address)
    assert not list(tmp_path.iterdir())
