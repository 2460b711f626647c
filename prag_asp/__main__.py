"""``python -m prag_asp`` is the command ``prag-asp``."""

from prag_asp.cli import main

if __name__ == "__main__":
    main()
