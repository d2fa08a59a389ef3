# SPDX-License-Identifier: GPL-3.0-or-later
"""Types: the extension module and its stub name the same things; the package is annotated throughout."""

import ast
import inspect
import pathlib
import subprocess
import sys
import unittest

import calot
import program
from calot import _calot

PACKAGE = pathlib.Path(calot.__file__).parent


def stubbed():
    """Names of the stub: of the module, and of each class."""
    module, classes = set(), {}
    for node in ast.parse((PACKAGE / "_calot.pyi").read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef):
            classes[node.name] = {n.name for n in node.body if isinstance(n, ast.FunctionDef)} - {"__init__"}
            module.add(node.name)
        elif isinstance(node, ast.FunctionDef):
            module.add(node.name)
        elif isinstance(node, ast.AnnAssign):
            module.add(node.target.id)
    return module, classes


class Stubs(unittest.TestCase):
    maxDiff = None

    def test_extension(self):
        module, classes = stubbed()
        self.assertEqual({n for n in dir(_calot) if not n.startswith("_")}, module)
        for name, members in classes.items():
            self.assertEqual({n for n in vars(getattr(_calot, name)) if not n.startswith("_")}, members, name)

    def test_package(self):
        public = {n for n, v in vars(calot).items() if not n.startswith("_") and not inspect.ismodule(v)}
        self.assertEqual(public, set(calot.__all__))
        self.assertTrue((PACKAGE / "py.typed").exists())
        for name in calot.__all__:
            thing = getattr(calot, name)
            if inspect.isfunction(thing):
                self.annotated(thing)
            elif inspect.isclass(thing):
                self.assertTrue(thing.__doc__, name)
                for member in vars(thing).values():
                    if inspect.isfunction(member):
                        self.annotated(member)
                    elif isinstance(member, property):
                        self.annotated(member.fget)

    def annotated(self, function):
        if function.__module__ is None or not function.__module__.startswith("calot") or function.__qualname__.startswith("__"):
            return
        signature = inspect.signature(function)
        if function.__name__ not in ("__eq__", "__hash__", "__repr__", "__init__", "__setattr__", "__delattr__"):  # a dataclass makes these
            self.assertIsNot(signature.return_annotation, inspect.Signature.empty, function.__qualname__)
            for parameter in signature.parameters.values():
                if parameter.name not in ("self", "cls"):
                    self.assertIsNot(parameter.annotation, inspect.Parameter.empty, f"{function.__qualname__}: {parameter.name}")

    def test_mypy(self):
        if subprocess.run([sys.executable, "-c", "import mypy"], capture_output=True, check=False).returncode != 0:
            self.skipTest("mypy is not installed")
        done = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--cache-dir=/dev/null", "--ignore-missing-imports", str(PACKAGE)], capture_output=True,
                              text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    program.main()
