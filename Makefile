# make sil    make the environment .venv and fly the default scenario
# make test   the tests, but for the long ones: some three minutes; by the compiled flight code, those that replace parts of it interpreted
# make compiled   does the flight code run compiled? if not, why not, and an error
# make test-interpreted   the tests, but for the long ones, all interpreted
# make test-long   those of over a sixth of a second: many orbits, processes, waits in real time; on a CAN interface where there is one: half an hour
# make test-paced   of the long ones, those that keep deadlines in real time: they want a core for themselves
# make test-unpaced   the other long ones; UNPACED has more words for pytest
# make test-firmware   of these those of firmware in C and MicroPython, and of torquer judge; FIRMWARE as UNPACED
# make lint   style, types, layers, generated code, pages and pictures
# make evidence   all that docs/ states of flights: gains, population, validate, comparison, faults, pulse limits, sizing; stopped, it goes on where it was
# make gains population validate comparison faults pulse-limits sizing   one of them, or some
# make same-flights SINCE=COMMIT   are all flights byte for byte those of the commit? a quarter of an hour
# make replay-elsewhere   does a log of 20 orbits replay with other processor features, into docs/replay.md
# make bench      how fast flights are beside Basilisk in the same minutes, into docs/performance.md: ten minutes
# make basilisk   fly the flight software over Basilisk's spacecraft beside our own plant, into docs/basilisk.md: two minutes
# make scaling    what a campaign costs beside its flights, and what 10^6 runs take, into docs/scaling.md: ten minutes
# make soak       72 simulated hours, and an hour on the bench in real time, into docs/soak.md
# make golden     record the golden logs again: after a change that means to alter the answers of fsw
# make docs      build the documentation into build/docs, each warning an error: half a minute
# make docs-gallery   the same, with notebooks and gallery executed: some minutes
# make notebooks   execute the notebooks of docs/notebooks, into build/notebooks: some minutes
# make test-vcan   the tests on a CAN interface, in a user-mode Linux guest where this kernel has no vcan
# make test-chromium   the pages in a headless browser, Debian's chromium
# make fuzz       a million random frames, a thousand mutations of each kind of input file, 200 recorded passes with a spoilt row: half an hour
# make scenarios  300 random legal scenarios of up to two orbits, read and judged again: a quarter of an hour
# make attack     a million requests to a coil board, and to the one in C; ten minutes on its process, a thousand logs: three quarters of an hour
# make firmware-qemu   the coil board in C on an emulated Cortex-M3: size, conformance, a million requests, into docs/firmware-qemu.md: twenty minutes
# make differential scheduler against interlock over 100 orbits of whole flights: some minutes
# make verdicts   all flights that miss a requirement for a known reason: is it told, and no wrong one: a minute
# make causes     satellites that have one cause each: which does their diagnosis name? twenty minutes
# make planted    schedulers with planted faults, and correct ones, through sim.testing as a user would run it: some minutes
# make validate-planted   errors planted in laws, models and filter: does validate end with exit code 1? some minutes
# make mutation     change scheduler, interlock, auditor and codec one thing, the methods one sign at a time: do the tests notice? two hours
# make coverage     branch coverage of the same modules, which must be complete, into the same page: a minute

PYTHON ?= python3
PYTEST_FLAGS ?= -q -rs -n 2 --dist worksteal
PYTHONS ?=

bin := .venv/bin
installed := .venv/.installed
kernel := .venv/.kernel
compiled := .venv/.compiled
# Python compiles a module at its first import, and most of these are never imported
pip := TORQUER_INTERPRETED=1 $(bin)/pip install --quiet --disable-pip-version-check --no-compile
export PATH := $(CURDIR)/$(bin):$(PATH)

.PHONY: help venv environment compiled sil test test-interpreted test-long test-unpaced test-firmware test-paced lint docs docs-gallery notebooks test-vcan test-chromium evidence gains population validate comparison faults pulse-limits sizing golden causes same-flights fuzz scenarios attack firmware-qemu differential replay-elsewhere bench basilisk scaling soak verdicts planted validate-planted mutation coverage

help:
	@sed -n 's/^# \(make .*\)/\1/p' Makefile

# an edit of the flight code compiles it again, but where it is to run interpreted
venv: environment $(if $(filter-out 0,$(TORQUER_INTERPRETED)),,$(compiled))

environment: $(installed) $(kernel)

$(installed): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit("torquer needs Python 3.11 or newer: make PYTHON=python3.11 ..." if sys.version_info < (3, 11) else 0)'
	@echo 'Making the environment .venv (a minute or two the first time)'
	@$(PYTHON) -m venv .venv
	@$(pip) --editable '.[dev]'
	@touch $@

$(kernel): fsw/core/estimation/kalman_kernel.c hatch_build.py $(installed)
	$(bin)/python hatch_build.py
	@touch $@

# which of these have changed, and whether any is of the group, is seen at once
$(compiled): tools/compile_group.py $(shell find fsw hil_stub sim -name '*.py') $(installed)
	@$(bin)/python tools/compile_group.py
	@touch $@

compiled: venv
	@$(bin)/python tools/compile_group.py --check
	@$(bin)/python -c 'import fsw, fsw.core.estimation._kalman_kernel'

sil: venv
	$(bin)/torquer sil

# a worker, a core
test test-interpreted test-unpaced test-firmware test-paced scenarios: export OPENBLAS_NUM_THREADS = 1
interpreted := TORQUER_INTERPRETED=1 $(bin)/pytest $(PYTEST_FLAGS)

test: venv
	$(bin)/pytest $(PYTEST_FLAGS)
	$(interpreted) -m "interpreted and not long"

test-interpreted: environment
	$(interpreted)

test-long: test-unpaced test-paced

test-unpaced: venv
	$(bin)/pytest $(PYTEST_FLAGS) -n 3 --durations=30 -m "long and not paced" $(UNPACED)
	$(interpreted) -m "interpreted and long" $(UNPACED)

test-firmware: venv
	$(bin)/pytest $(PYTEST_FLAGS) -n 1 -m "long and not paced" tests/firmware tests/sim/judge $(FIRMWARE)

test-paced: venv
	$(bin)/pytest $(PYTEST_FLAGS) -n 0 -m "long and paced and alone"
	$(bin)/pytest $(PYTEST_FLAGS) -n 4 --dist loadfile -m "long and paced and not alone"

lint: environment
	$(bin)/ruff check
	$(bin)/ruff format --check
	$(bin)/mypy
	$(bin)/lint-imports --no-logo
	$(bin)/python tools/generate_messages.py --check
	$(bin)/python tools/generate_state_bytes.py --check
	$(bin)/python tools/generate_icd.py --check
	$(bin)/python tools/draw_design.py --check
	$(bin)/python tools/write_pages.py --check

docs_installed := .venv/.docs-installed
sphinx := $(bin)/sphinx-build -W -n --keep-going --quiet -b html

$(docs_installed): $(installed)
	$(pip) --editable '.[docs]'
	@touch $@

docs: $(docs_installed)
	$(sphinx) docs build/docs
	@echo build/docs/index.html

docs-gallery: $(docs_installed)
	$(sphinx) -D plot_gallery=True -D nb_execution_mode=force docs build/docs-gallery
	@rm -rf examples/gallery/runs examples/gallery/campaigns
	@echo build/docs-gallery/index.html

notebooks: venv
	$(bin)/python tools/run_notebooks.py $(NOTEBOOKS)

test-vcan: venv
	TORQUER_REQUIRE_VCAN=1 tests/with-vcan $(bin)/pytest -q -rs -p no:cacheprovider -m vcan tests/integration

test-chromium: venv
	TORQUER_REQUIRE_CHROMIUM=1 $(bin)/pytest -q -rs -p no:cacheprovider -m chromium tests/sim

evidence: venv
	$(bin)/python tools/evidence.py

gains population validate comparison faults pulse-limits sizing: venv
	$(bin)/python tools/evidence.py $@

causes: venv
	$(bin)/python tools/cause_matrix.py

golden: venv
	$(bin)/python tests/golden/record.py

fuzz: venv
	TORQUER_FUZZ_FRAMES=1000000 TORQUER_FUZZ_MUTATIONS=1000 TORQUER_CORRUPT_PASSES=200 $(bin)/pytest -q --timeout 7200 tests/fuzz

scenarios: venv
	TORQUER_SCENARIOS=0:300 $(bin)/pytest $(PYTEST_FLAGS) tests/fuzz/test_legal_scenarios.py

attack: venv
	TORQUER_ATTACK_REQUESTS=1000000 TORQUER_ATTACK_SECONDS=600 TORQUER_ATTACK_LOGS=1000 $(bin)/pytest -q -s tests/attack tests/firmware/test_attack.py tests/firmware/test_twin.py

firmware-qemu: venv
	PYTHONPATH=tests/shared $(bin)/python tests/firmware/record.py

differential: venv
	TORQUER_DIFFERENTIAL_ORBITS=100 $(bin)/pytest -q --timeout 3600 tests/differential

replay-elsewhere: venv
	$(bin)/python tools/replay_elsewhere.py $(foreach other,$(PYTHONS),--python $(other))

bench: venv
	$(bin)/python tools/bench.py

# the environment that make bench makes too: Basilisk is no part of ours
peer := build/basilisk
peer_installed := $(peer)/.example-installed

$(peer_installed):
	@echo 'Making the environment $(peer), with Basilisk'
	@test -x $(peer)/bin/python || $(PYTHON) -m venv $(peer)
	@$(peer)/bin/pip install --quiet --disable-pip-version-check 'bsk>=2.12' 'h5py>=3.11'
	@touch $@

basilisk: export OPENBLAS_NUM_THREADS = 1

basilisk: venv $(peer_installed)
	$(peer)/bin/python examples/basilisk_plant/compare.py --page docs/basilisk.md

scaling: venv
	$(bin)/python tools/scaling.py

same-flights: venv
	$(bin)/python tools/same_flights.py $(SINCE)

soak: venv
	$(bin)/python tools/soak.py $(SOAK)

verdicts: venv
	TORQUER_FAILING_FLIGHTS=all $(bin)/pytest -q tests/sim/report/requirements/test_failing_flights.py

planted: venv
	TORQUER_SCHEDULER_FLIGHTS=200 $(bin)/pytest -q --timeout 1800 tests/sim/testing/test_audit_scheduler.py
	$(bin)/python tools/planted.py $(PLANTED)

validate-planted: venv
	$(bin)/python tools/validate_planted.py $(PLANTED)

mutation: venv
	$(bin)/python tools/mutate.py $(MUTATE)

coverage: export TORQUER_INTERPRETED = 1

coverage: venv
	$(bin)/coverage erase
	$(bin)/coverage run -m pytest -q -p no:cacheprovider tests/fsw/wire tests/fsw/core/actuation \
		tests/hil_stub/coils/test_interlock.py tests/hil_stub/coils/test_guard.py tests/hil_stub/coils/test_coil_driver.py \
		tests/hil_stub/coils/test_read_back.py tests/hil_stub/test_node.py tests/sim/audit tests/sim/record/test_log_index.py
	@mkdir -p build
	$(bin)/coverage json -q --fail-under 0 -o build/coverage.json
	$(bin)/python tools/mutate.py --coverage build/coverage.json
	$(bin)/coverage report
