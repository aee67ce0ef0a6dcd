"""HTML pages without external resources: one shell and the style that all pages share."""

import hashlib
from base64 import b64encode
from html import escape
from pathlib import Path
from string import Template

#: Colours, fonts and tables of all pages; a page's own style follows.
STYLE = Path(__file__).with_name("html_page.css")
#: An empty icon: without one a browser would ask a server for it.
PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="$policy">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<link rel="icon" href="data:,">
<title>$title</title>
<style>$style</style>
</head>
<body>
$body
$script</body>
</html>
""")


def html_page(title: str, body: str, style: str, script: str = "") -> str:
    """A page as text, with a policy that permits exactly this style and script, and no requests.

    Parameters
    ----------
    title : str
        Title, as plain text.
    body : str
        Contents, as HTML.
    style : str
        Style sheet of this page, which follows the common one.
    script : str, optional
        JavaScript module.
    """
    style = f"{STYLE.read_text(encoding='utf-8')}\n{style}"
    policy = f"default-src 'none'; style-src {_hash(style)}; img-src data:; base-uri 'none'; "
    policy += "form-action 'none'"
    if script:
        policy += f"; script-src {_hash(script)}"
        script = f'<script type="module">{script}</script>\n'
    values = {"title": escape(title), "style": style, "body": body, "script": script}
    # Template substitutes once, so that nothing is substituted in the texts themselves
    return PAGE.substitute(values, policy=policy)


def _hash(text: str) -> str:
    return f"'sha256-{b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"
