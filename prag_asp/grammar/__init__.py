"""Languages as tables: the words that each language has for all domains, and the sentences that a domain adds.

A language is a file in this package (``en.toml``); a domain's part of it is a table ``[language.en]`` in its
domain.toml. The code is independent of English: articles, genders, cases, endings and word order are table entries.
"""
