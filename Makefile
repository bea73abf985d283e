# make demo    simulate a crowd, solve it, score it, draw it
# make test    the tests
# make soak    the tests that take minutes: many kills, many random recordings, long and large scenes
# make fuzz    changed files for every reader, MINUTES each
# make check   formatting, lint, types, tests
# Each makes .venv and installs what is missing first; a second call installs nothing.

VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
DEMO := demo
WORKERS ?= 2
MINUTES ?= 10
READERS ?= scene family sweep settings corrections recording manifest frame xray truth motions bvh walks \
  png tiff pgm exr npz npy npy_points mat mat73 ply pcd xyz ros1 mcap db3 bag_metadata \
  camera camera_yaml camera_storage camera_xml extrinsics extrinsics_text extrinsics_npy tum_times tum_places \
  stages journal

.PHONY: demo test soak fuzz check format clean

demo: $(READY)
	$(BIN)/unocclude demo --output $(DEMO) --overwrite

test: $(READY)
	$(BIN)/pytest --numprocesses $(WORKERS)

soak: $(READY)
	$(BIN)/pytest -m soak

fuzz: $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[fuzz]'
	for reader in $(READERS); do $(BIN)/python fuzz/run.py $$reader --minutes $(MINUTES) || exit 1; done

check: $(READY)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(MAKE) test

format: $(READY)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

# trackeval, the reference for the identity scores, asks for opencv-python, whose files would replace
# those of opencv-contrib-python-headless: hence without its dependencies, which are here anyway.
$(READY): pyproject.toml constraints.txt
	test -x $(BIN)/python || python3 -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[test,check]'
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --no-deps trackeval
	touch $@

clean:
	rm -rf $(VENV) $(DEMO) pictures build dist *.egg-info
