"""Runs pytest in a folder; 77 (skipped) and a word where pytest or NumPy is not installed."""
import importlib.util
import subprocess
import sys

for module, package in (("pytest", "python3-pytest"), ("numpy", "python3-numpy")):
    if importlib.util.find_spec(module) is None:
        print(f"skipped: the Debian package {package} is not installed")
        sys.exit(77)
sys.exit(subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *sys.argv[1:]]).returncode)
