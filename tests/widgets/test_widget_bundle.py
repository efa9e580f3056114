"""Scripts as one module: each once, after what it imports, and only as code."""

from ddlib.widgets import bundle


def test_a_script_stands_once_and_only_as_code(tmp_path):
    texts = {
        "a.js": 'import { b } from "./b.js";\nimport {\n  c,\n} from "./c.js";\n\nb(c);\n',
        "b.js": '// About b.\n\nimport { c } from "./c.js";\n\nexport function b() {\n  c;\n}\n',
        "c.js": "export const c = 1;\nexport default { c };\n",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert bundle(tmp_path / "a.js", tmp_path / "b.js").splitlines() == [
        "const c = 1;", "export default { c };", "function b() {", "c;", "}", "b(c);"]  # fmt: skip
