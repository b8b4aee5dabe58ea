#!/usr/bin/env bash
# Writes the documentation site to build/site: docs/ by mkdocs, with the references of C++ and Python. A warning, a dead
# link and a command line that the program does not know are failures.
# Usage: scripts/build_docs.sh     after building the program and the Python package (-DKINLOOP_PYTHON=ON)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scripts/build_api_docs.sh
/usr/bin/python3 scripts/stage_docs.py build/docs build/api/html
/usr/bin/python3 scripts/python_reference.py build/release/python >build/docs/python_reference.md
/usr/bin/mkdocs build --config-file docs/mkdocs.yml --strict --clean --quiet
/usr/bin/python3 scripts/check_links.py build/site
/usr/bin/python3 scripts/check_documents.py build/release/apps/kinloop
echo "Documentation: $PWD/build/site/index.html"
