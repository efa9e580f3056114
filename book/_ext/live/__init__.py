"""*Run this page*: lessons whose cells run in the browser. README.md says how."""
