"""Local pages for a task space or the answer sets of a program: page states, the views that they show, and the server.

PageState  <->  query of a link
    |
views on a TaskSpace (pure functions)  ->  JSON  ->  page
"""
