"""What the build takes out of the pages and their styles."""

import json

import pytest
import slim


class NoIcons:
    """In place of the theme's icon font."""

    def inline(self, attributes):
        return ""


def test_no_other_address_than_data_is_opened(tmp_path):
    for address in ("http://localhost/x.svg", "file:///etc/hostname", "x.svg"):
        with pytest.raises(ValueError, match=r"^address must begin with data:"):
            slim.keep(tmp_path / "_images", "../", address)
    assert not list(tmp_path.iterdir())


def test_stills_leave_the_state_of_widgets_for_files():
    state = {"state": {"m": {"state": {"still": "data:x", "still_alt": 'a "<" b', "k": "</p>"}}}}
    state = json.dumps(state).replace("</", "<\\/")
    kind = "application/vnd.jupyter.widget-"
    text = (
        f'<script type="{kind}view+json">{{"model_id": "m"}}</script><p>1</p>'
        f'<script type="{kind}state+json">{state}</script>'
    )
    made = slim.slim_page(text, NoIcons(), lambda address: f"_images/{address[5:]}.svg")
    assert (
        '<noscript><img class="still" src="_images/x.svg" alt="a &quot;&lt;&quot; b"></noscript>'
        "<p>1</p>" in made
    )
    assert made.endswith('"still_alt": "a \\"<\\" b", "k": "<\\/p>"}}}}</script>')
    assert "data:" not in made
