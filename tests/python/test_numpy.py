"""Which versions of NumPy the package accepts."""

import numpy as np
import pytest

from kinloop import _kinloop, _numpy


def test_the_installed_one_is_known():
    _numpy.require_known(np.__version__, _kinloop._knows_numpy_2)


def test_numpy_2_is_refused_by_builds_that_would_misread_its_arrays():
    with pytest.raises(ImportError, match=r"NumPy 2\.4\.6 is installed; pip install 'numpy<2'"):
        _numpy.require_known("2.4.6", False)


def test_other_pairs_are_accepted():
    _numpy.require_known("1.26.4", False)
    _numpy.require_known("1.26.4", True)
    _numpy.require_known("2.0.0", True)
