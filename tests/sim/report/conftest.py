"""A run with all that is made of it, flights made up, and their pages taken apart."""

import json
import re
import shutil
from dataclasses import dataclass, field
from fractions import Fraction
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from fsw.wire.messages import Mode
from sim.audit.auditor import AuditLimits, AuditReport
from sim.audit.check import check
from sim.audit.findings import DrivenPulse, Violation
from sim.record.estimates import Estimates
from sim.record.truth import Histories
from sim.report.charts.drawn_flight import DrawnFlight
from sim.report.charts.lines import Lines
from sim.report.conclude import conclude
from sim.report.figures.performance import blocks, perform
from sim.report.page import write_report
from sim.report.summary import BusTally, summarise
from sim.scenario.schema import Scenario, load

VOID = {"meta", "br", "hr", "img", "link", "input"}


class Page(HTMLParser):
    """A page taken apart; a tag that is closed out of turn fails."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.source = text
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str, str]] = []
        self.scripts: list[str] = []
        self.text: list[str] = []
        self.texts: dict[str, list[str]] = {}
        self.paths: dict[str, list[str]] = {}
        self._open: list[tuple[str, str | None]] = []
        self.feed(text)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag, attrs):
        self.handle_startendtag(tag, attrs)
        if tag not in VOID:
            self._open.append((tag, dict(attrs).get("id") if tag == "figure" else None))

    def handle_startendtag(self, tag, attrs):
        self.tags.append(tag)
        if tag == "script":
            self.scripts.append("")
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        figure = self._figure()
        if tag == "path" and figure:
            self.paths.setdefault(figure, []).append(dict(attrs)["d"])

    def handle_endtag(self, tag):
        opened, _ = self._open.pop()
        assert opened == tag

    def handle_data(self, data):
        if self._open and self._open[-1][0] == "script":
            self.scripts[-1] += data
        elif data.strip() and self._open[-1][0] != "style":
            self.text.append(data.strip())
            self.texts.setdefault(self._figure() or "", []).append(data.strip())

    def _figure(self):
        return next((figure for _, figure in reversed(self._open) if figure), None)

    @property
    def data(self):
        """What the scripts draw."""
        return json.loads(self.scripts[1])

    @property
    def written(self):
        """The source without the scripts of all pages."""
        return re.sub("<script.*?</script>", "", self.source, flags=re.DOTALL)

    def values(self, name):
        return [value for _, attribute, value in self.attributes if attribute == name]

    def drawn(self, figure, group):
        """The path data of a group of a figure, such as ``eclipse``, one for each panel that has it."""
        start = self.source.index(f'<figure id="{figure}"')
        figure_text = self.source[start : self.source.index("</figure>", start)].partition('class="narrow"')[
            0
        ]
        return re.findall(rf'<g class="{group}">\s*<path d="([^"]*)"', figure_text)


FLOWN = {"seed": 7, "flown": {"ticks": 7000, "slips": 0, "wall_s": None}}
"""Of run.json, what a summary needs of a flight that came to its end."""
MET = {"index": "ape", "at_most_deg": 60.0, "by_orbit": 1.0}
"""What a flight made up points to, if it lasts for an orbit."""


@dataclass
class Run:
    """A flight made up: a libration that decays, an estimate a little off, pulses as they are given."""

    ticks: int = 7000
    pulses: tuple[DrivenPulse, ...] = tuple(
        DrivenPulse(i % 3, (-3, -2, -1, 1, 2, 3)[i % 6], Fraction(100 + 110 * i), Fraction(103 + 110 * i))
        for i in range(12)
    )
    violations: tuple[Violation, ...] = ()
    notes: tuple[str, ...] = ()
    limits: AuditLimits = field(default_factory=AuditLimits)
    complete: bool = True
    refused: int = 0
    replay: dict[str, object] | None = field(
        default_factory=lambda: {"bit_exact": True, "command_exact": True}
    )
    scenario: Scenario = field(default_factory=lambda: load("microsat", {"requirement": [MET]}))
    events: list[dict[str, object]] = field(default_factory=list)
    isolated: list[str] = field(default_factory=list)

    def truth(self) -> Histories:
        t = np.arange(self.ticks, dtype=float)
        half = np.radians(20.0) * np.exp(-t / 3000.0)
        noise = np.random.default_rng(1).standard_normal((self.ticks, 3))
        axis = np.array([0.6, 0.0, 0.8])
        return {
            "t_s": t,
            "q_body_from_orbit": np.hstack((np.cos(half)[:, None], np.sin(half)[:, None] * axis)),
            "omega_body_orbit_radps": 1e-4 * noise,
            "b_body_t": 3e-5 * np.stack((np.cos(t / 960.0), np.sin(t / 960.0), 0.0 * t), axis=1),
            "sun_body": np.tile([1.0, 0.0, 0.0], (self.ticks, 1)),
            "lit": np.where((t >= 1000.0) & (t < 3000.0), 0.0, 1.0),
            "m_body_am2": np.where(np.abs(noise) > 2.0, 8.0 * np.sign(noise), 0.0),
            "r_eci_m": np.tile([7.1e6, 0.0, 0.0], (self.ticks, 1)),
            "torque_body_nm/gravity_gradient": 1e-7 * noise,
            "torque_body_nm/coils": np.where(np.abs(noise) > 2.0, 1e-4, 0.0),
            "torque_body_nm/residual_dipole": np.zeros((self.ticks, 3)),
        }

    def estimates(self) -> Estimates:
        truth = self.truth()
        normal = np.tile([0.0, 0.0, 1.04e-3], (self.ticks, 1))
        return Estimates(
            q_body_from_orbit=truth["q_body_from_orbit"],
            omega_body_orbit_radps=truth["omega_body_orbit_radps"],
            omega_body_radps=truth["omega_body_orbit_radps"] + normal,
            covariance=np.tile(np.diag([1e-6] * 3 + [1e-10] * 3), (self.ticks, 1, 1)),
            valid=np.ones(self.ticks, dtype=bool),
            mode=np.where(np.arange(self.ticks) < self.ticks // 2, Mode.ACQUIRE, Mode.POINT),
        )

    def audit(self) -> AuditReport:
        return AuditReport(
            limits=self.limits,
            pulses=self.pulses,
            violations=self.violations,
            notes=self.notes,
            statuses=self.ticks,
            span_s=Fraction(max(self.ticks - 1, 0)),
            truncated_at=None,
            complete=self.complete,
        )

    def flown(self, **truth: np.ndarray) -> DrawnFlight:
        return DrawnFlight.of(self.scenario, self.lines(self.truth() | truth, self.estimates()), self.audit())

    def lines(self, truth: Histories, estimates: Estimates) -> Lines:
        lines = Lines(self.ticks, self.scenario)
        for block in blocks(truth, estimates):
            lines.take(*block)
        return lines

    def write(self, path: Path, estimates: Estimates | None = None, **truth: np.ndarray) -> Page:
        histories = self.truth() | truth
        estimates = estimates or self.estimates()
        tally = BusTally(0, self.refused, self.events, self.isolated, event_count=len(self.events))
        performance = perform(self.scenario, histories, estimates)
        summary = summarise(self.scenario, FLOWN, performance, self.audit(), tally)
        if self.replay is not None:
            summary["replay"] = self.replay
        lines = self.lines(histories, estimates)
        write_report(path / "report.html", self.scenario, summary, lines, self.audit())
        return Page((path / "report.html").read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def made_run():
    """Makes up a flight: keywords are its fields."""
    return Run


@pytest.fixture(scope="session")
def page(tmp_path_factory):
    """The page of a whole flight."""
    return Run().write(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="session")
def strict():
    """Reads JSON as every other language does: no NaN, no infinity."""

    def refuse(name):
        raise ValueError(name)

    return lambda text: json.loads(text, parse_constant=refuse)


@pytest.fixture(scope="session")
def concluded(recorded_run, tmp_path_factory):
    """A copy of a run with all that is made of it."""
    path = tmp_path_factory.mktemp("concluded") / "run"
    shutil.copytree(recorded_run, path)
    conclude(path)
    return path


@pytest.fixture(scope="session")
def audit(concluded):
    """A real audit: what it found is not of interest where this is used."""
    return check(concluded, None)
