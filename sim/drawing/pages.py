"""Self-contained HTML pages of one look, by Jinja2: all content is escaped, unless it is Markup."""

from base64 import b64encode
from collections.abc import Sequence
from hashlib import sha256
from importlib import resources

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from jinja2.utils import htmlsafe_json_dumps
from markupsafe import Markup

from sim.drawing import palette
from sim.value_types import Json

OWN = "sim.drawing"
THEME = "script/theme.js"
UPLOT, UPLOT_CSS, UPLOT_LICENCE = "vendor/uPlot.iife.min.js", "vendor/uPlot.min.css", "vendor/uPlot.LICENSE"
VIEWS = ("script/turned_view.js", "script/coil_view.js")
PLOTTING = ("script/clock.js", "script/charts.js", *VIEWS)
LOOPBACK = "ws://127.0.0.1:* ws://localhost:*"


def page(
    package: str, template: str, data: Json | None = None, scripts: Sequence[str] = (), **content: object
) -> str:
    """The page that a template makes of its content.

    The browser runs the scripts of the page by their digests and loads nothing, whatever the content holds.

    Args:
        package: whose folder ``templates`` holds the template; it may use those beside this module.
        template: name of the file.
        data: what the charts against time are drawn from; None: the page has none.
        scripts: of the package, by their paths, that draw more of the data.
        content: what the template names.

    Raises:
        jinja2.TemplateError: the template names what is not there, or is malformed.
        ValueError: the data hold a number that JSON has not.
    """
    css, run = "", [_read(OWN, THEME)]
    if data is not None:
        css = _read(OWN, UPLOT_CSS) + "\n"
        run += [
            _uplot(),
            *(_read(OWN, name) for name in PLOTTING),
            *(_read(package, name) for name in scripts),
        ]
    text = None if data is None else htmlsafe_json_dumps(data, allow_nan=False, separators=(",", ":"))
    return _render(package, template, css, run, "", {**content, "data": text})


def live_page(package: str, template: str, scripts: Sequence[str], **content: object) -> str:
    """A page whose scripts draw what comes over a websocket of this machine; they load nothing else.

    Args:
        package: as of ``page``.
        template: as of ``page``.
        scripts: of the package, by their paths; they have uPlot, ``turnedView`` and ``coilView``.
        content: what the template names.
    """
    run = [_read(OWN, THEME), _uplot(), *(_read(OWN, name) for name in VIEWS)]
    run += [_read(package, name) for name in scripts]
    css = _read(OWN, UPLOT_CSS) + "\n"
    return _render(package, template, css, run, f"; connect-src {LOOPBACK}", {**content, "data": None})


def _render(
    package: str, template: str, css: str, scripts: list[str], allowed: str, content: dict[str, object]
) -> str:
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader(OWN)]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    css += _read(OWN, "report.css").replace("/* colours of charts */", palette.css())
    policy = f"default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src {_digests(scripts)}"
    return environment.get_template(template).render(
        css=Markup(css), scripts=[Markup(text) for text in scripts], policy=policy + allowed, **content
    )


def _uplot() -> str:
    """The plot library with its licence, which every copy must bear."""
    return f"/*\n{_read(OWN, UPLOT_LICENCE)}*/\n{_read(OWN, UPLOT)}"


def _read(package: str, name: str) -> str:
    return resources.files(package).joinpath(name).read_text(encoding="utf-8")


def _digests(scripts: Sequence[str]) -> str:
    """The scripts as sources of a content security policy."""
    digests = (b64encode(sha256(script.encode()).digest()).decode("ascii") for script in scripts)
    return " ".join(f"'sha256-{digest}'" for digest in digests)
