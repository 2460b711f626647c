"""Languages as tables: the words that each has for all domains, and the sentences that a domain adds.

A language is a file of this room (``en.toml``), a domain's part of it a table ``[language.en]`` of its domain.toml.
Nothing here knows English: articles, genders, cases, endings and the order of words are entries of a table.
"""
