# make demo    simulate a crowd, solve it, score it, draw it
# make test    the tests
# make check   formatting, lint, types, tests
# Each makes .venv and installs what is missing first; a second call installs nothing.

VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
DEMO := demo
WORKERS ?= 2

.PHONY: demo test check format clean

demo: $(READY)
	$(BIN)/unocclude demo --output $(DEMO) --overwrite

test: $(READY)
	$(BIN)/pytest --numprocesses $(WORKERS)

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
