"""Numbers as arguments: named as a reader would, in the help and where one is wrong."""

import click


class Number(click.FloatRange):
    """A number within limits."""

    name = "number"


class WholeNumber(click.IntRange):
    """A whole number within limits."""

    name = "whole number"
