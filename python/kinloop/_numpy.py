"""Refuses a NumPy whose arrays this build of the module would misread."""


def require_known(numpy_version, knows_numpy_2):
    """Raises ImportError for NumPy 2 unless the module was built with pybind11 2.12 or newer: an older one reads the
    arrays of NumPy 2 wrongly, and returns other numbers or crashes."""
    if int(numpy_version.split(".")[0]) >= 2 and not knows_numpy_2:
        raise ImportError(f"this build of kinloop knows NumPy 1 only, and NumPy {numpy_version} is installed; "
                          "pip install 'numpy<2', or build kinloop with pybind11 2.12 or newer")
