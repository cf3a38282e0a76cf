"""The tutorial of the site: the notebook with its outputs, which the repository does not keep."""

import tempfile

import nbformat
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from nbclient import NotebookClient
from nbconvert import MarkdownExporter
from nbconvert.preprocessors import CoalesceStreamsPreprocessor
from pages import ROOT
from traitlets.config import Config

NOTEBOOK = "docs/tutorial.ipynb"
PICTURES = "tutorial_pictures"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Run the notebook and add it as a page, with its pictures beside it."""
    notebook = nbformat.read(ROOT / NOTEBOOK, as_version=4)
    if config.extra["execute"]:
        with tempfile.TemporaryDirectory() as folder:
            # sockets of this folder: the kernel warns of those of the net
            sockets = Config({"KernelManager": {"transport": "ipc", "ip": f"{folder}/kernel"}})
            resources = {"metadata": {"path": folder}}
            NotebookClient(notebook, config=sockets, timeout=300, resources=resources).execute()
    exporter = MarkdownExporter()
    exporter.register_preprocessor(CoalesceStreamsPreprocessor, enabled=True)
    text, resources = exporter.from_notebook_node(
        notebook, resources={"output_files_dir": PICTURES}
    )
    for name, content in {"tutorial.md": text, **resources["outputs"]}.items():
        file = File.generated(config, f"docs/{name}", content=content)
        file.dest_uri = name if name != "tutorial.md" else "tutorial/index.html"
        files.append(file)
    return files
