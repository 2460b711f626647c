"""``python -m prag_asp`` is the command ``prag-asp``."""

from prag_asp.cli import main

main()
