"""Local pages for a task space or the answer sets of a program: states of a page, the views that they show, the server.

PageState  <->  query of a link
    |
views on a TaskSpace (pure functions)  ->  JSON  ->  page
"""
