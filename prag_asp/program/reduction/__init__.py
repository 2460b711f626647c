"""Entities of which no more are ground than plans can name: which they are, and the program with fewer of them."""
