"""Self-contained HTML pages of one look, by Jinja2: all content is escaped, unless it is Markup."""

from importlib import resources

from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from markupsafe import Markup


def page(package: str, template: str, **content: object) -> str:
    """The page without scripts that a template makes of its content.

    Args:
        package: whose folder ``templates`` holds the template; it may use those beside this module.
        template: name of the file.
        content: what the template names.

    Raises:
        jinja2.TemplateError: the template names what is not there, or is malformed.
    """
    environment = Environment(
        loader=ChoiceLoader([PackageLoader(package), PackageLoader("sim.drawing")]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    css = resources.files("sim.drawing").joinpath("report.css").read_text(encoding="utf-8")
    return environment.get_template(template).render(css=Markup(css), **content)
