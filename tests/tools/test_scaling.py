"""The page of ``make scaling``, from invented figures."""

from scaling import Figures, Taken, page

FIGURES = Figures(
    run_s=8.0,
    alone=Taken(4, 34.0, 0.1),
    both=Taken(8, 36.0, 0.1),
    sleeping={"processes": Taken(80, 88.0, 0.1), "Dask": Taken(80, 84.0, 0.1, 0.5)},
    idle={"processes": Taken(3000, 10.0, 1.5), "Dask": Taken(3000, 15.0, 1.2, 6.0)},
    row_bytes=12_000,
    stored_bytes=8000.0,
    page_runs=3000,
    page_s=3.0,
    page_bytes=48e6,
)


def test_the_figures_are_worked_out_for_many_runs():
    text = page(FIGURES)
    assert "8 runs, two workers | 4.5 s each: 1.89 times as fast" in text
    assert "processes: 8 workers that sleep for 8.0 s, 80 runs | 10.0 % longer" in text
    assert "Dask: rows from workers that do nothing | 200 a second are taken in" in text
    assert "Dask's scheduler for 2.0 ms" in text
    assert "2222 hours of one core" in text
    assert "| 1000 | 2.2 hours | 125.0 | 41.7 % | 62.5 % |" in text
    assert "8.0 GB, and a page of all of them would take 16 GB" in text
    assert "1000 000 runs in 16 GB" in text
    assert "1600 cores" in text


def test_no_line_of_the_page_is_longer_than_its_prose_should_be():
    prose = [line for line in page(FIGURES).splitlines() if not line.startswith("|")]
    assert max(map(len, prose)) <= 130
