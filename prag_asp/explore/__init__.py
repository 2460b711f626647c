"""A local page for browsing a task space: states of the page, the views that they show, and the server.

PageState  <->  query of a link
    |
views on a TaskSpace (pure functions)  ->  JSON  ->  page
"""
