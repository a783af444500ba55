# make house   set up the core, furnish an example plan and render it into out/
# make test    set up all extras, too, and run the tests of each commit
# make acceptance   the long tests: fuzzing, limits, whole houses, the commands of the documents
# make coverage   which lines of the package the unit tests run
# make lint    ruff and mypy
# make extension   build the Blender extension into dist/

PYTHON ?= $(shell command -v python3.11 || command -v python3)
BIN := .venv/bin
PLAN ?= examples/cut_corner.png
# Drafts: SIZE=1280x720 SAMPLES=64 for an evening, CAMERAS= for all of the house.
CAMERAS ?= LivingRoom_0 Isometric
SAMPLES ?= 8
SIZE ?= 640x360
# Plans whose houses fill the caches at set-up.
WARMING ?= examples/two_bedrooms.png examples/family_house.png
OUT ?= out
# What Blender's wheel (bpy) links to and a slim Debian lacks.
BLENDER_LIBRARIES := libegl1 libgl1 libgomp1 libice6 libopengl0 libsm6 libx11-6 libxext6 \
	libxfixes3 libxi6 libxkbcommon0 libxrender1 libxt6 libxxf86vm1

# Blender's own tool, out of the bpy wheel.
BLENDER_EXT := $(BIN)/../lib/python3.11/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py

# Tests start hundreds of interpreters; each compiles the package again where none keeps bytecode.
unexport PYTHONDONTWRITEBYTECODE

# One thread for each worker: threads of two pools on two cores wait for one another (two small
# networks learn a batch in 34 s of CPU so, and in more than 109 s otherwise). The third worker uses
# the time in which others wait for a cluster or a browser; each takes up to 3 GiB.
WORKERS ?= 3
PARALLEL = OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n $(WORKERS) --durations 40 --durations-min 4

# Tests whose limits are so near that they need the machine for themselves.
ALONE = $(shell grep -rl 'mark\.alone' tests)

# Programs that exports are for, from npm.
NODE := .venv/node
READERS := gltf-validator@2.0.0-dev.3.10 three@0.187.0

MINUTES ?= 30

.PHONY: setup setup-dev house test test-tools acceptance acceptance-tools coverage lint train-next wheel extension clean

setup: .venv/.ready .venv/.warm

setup-dev: .venv/.ready-dev .venv/.warm

.venv/.ready: pyproject.toml setup.py constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' \
		|| { echo "error: $(PYTHON) is not Python 3.11, which bpy asks for. Try: make PYTHON=/path/to/python3.11"; exit 2; }
	@$(PYTHON) -c 'import ensurepip' 2>/dev/null || $(call install,python3.11-venv)
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade-strategy only-if-needed -c constraints.txt -e .
	@! ldd $(BIN)/../lib/python3.11/site-packages/bpy/__init__.so 2>/dev/null | grep -q 'not found' \
		|| $(call install,$(BLENDER_LIBRARIES))
	$(BIN)/python -m compileall -q chord_usd
	@touch $@

# A first house draws what it needs itself, so that it waits for no others.
.venv/.warm: | .venv/.ready
	@$(fill_caches)
	@touch $@

# All extras, on top of what is there. Of their 300 MB of Python little is ever imported, so that
# it is compiled when it is: all of it takes a minute.
.venv/.ready-dev: .venv/.ready
	$(BIN)/python -m pip install --quiet --no-compile --upgrade-strategy only-if-needed -c constraints.txt -e '.[dev]'
	@touch $@

# Networks, skies, looks and half of the furniture of any house are then drawn and kept.
define fill_caches
houses=$$(mktemp -d); $(BIN)/chord-usd batch $(WARMING) -o $$houses/warming >$$houses/said 2>&1 \
	|| tail -n 3 $$houses/said; rm -r $$houses
endef

# Debian packages: installed when we may, named when we may not.
define install
{ if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends $(1); \
else echo "error: system packages are missing. Try: sudo apt-get install $(1)"; exit 2; fi; }
endef

house: .venv/.ready
	$(BIN)/chord-usd generate $(PLAN) -o $(OUT)/house.usda --layout-out $(OUT)/layout.png --preview $(OUT)/plan.png \
		|| test $$? = 1  # written, and its certificate does not hold: pictures show why
	$(BIN)/chord-usd render $(OUT)/house.usda -o $(OUT)/pictures $(CAMERAS:%=--camera %) --samples $(SAMPLES) --resolution $(SIZE)

# Programs that tests start, beside Python's packages.
test-tools: setup-dev
	@command -v strace >/dev/null || $(call install,strace)
	@command -v chromium >/dev/null || ($(call install,chromium)) || echo "no chromium: the page is not driven"

test: test-tools
	$(PARALLEL) --dist loadfile -m 'not acceptance' tests/unit
	$(PARALLEL) --dist loadfile --no-loadscope-reorder -m 'not alone and not acceptance' tests/end_to_end tests/step
	$(BIN)/python -m pytest -m 'alone and not acceptance' $(ALONE)

# Deadline's client asks for other versions of packages than we have: another environment.
acceptance-tools: test-tools
	@command -v slurmctld munged >/dev/null || $(call install,slurm-wlm munge)
	@test -x .venv/deadline/bin/deadline || ($(PYTHON) -m venv .venv/deadline && .venv/deadline/bin/pip install --quiet deadline)
	@test -d $(NODE)/node_modules/three || (mkdir -p $(NODE) && npm install --silent --prefix $(NODE) $(READERS)) \
		|| echo "no npm: no program from there reads exports"

acceptance: acceptance-tools
	$(PARALLEL) --dist loadfile -m 'acceptance and not alone' tests
	$(BIN)/python -m pytest -m 'acceptance and alone' $(ALONE) || test $$? = 5  # 5: there are none

# In one process: no subprocess of a test counts.
coverage: setup-dev
	OMP_NUM_THREADS=1 $(BIN)/python -m coverage run -m pytest -m 'not acceptance' tests/unit
	$(BIN)/python -m coverage report --format total

lint: setup-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy chord_usd

# MINUTES=30 FLATS=flats.jsonl.gz; goes on where the run in runs/ stopped.
train-next: setup-dev
	$(BIN)/chord-usd train next --minutes $(MINUTES) $(FLATS:%=--flats %)

wheel: setup
	$(BIN)/python -m pip wheel --quiet --no-deps --wheel-dir dist .

# With the Python that BIN names, as it is; only our own is set up first.
extension: $(if $(filter .venv/bin,$(BIN)),setup)
	@mkdir -p dist
	$(BIN)/python $(BLENDER_EXT) build --source-dir blender_addon --output-dir dist
	$(BIN)/python $(BLENDER_EXT) validate dist/chord_usd-*.zip

clean:
	rm -rf build dist out .mypy_cache .ruff_cache .pytest_cache .hypothesis .coverage
