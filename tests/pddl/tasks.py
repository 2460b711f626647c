"""Small domains of PDDL with a problem each, written for these tests: classics, and one for each requirement."""

from __future__ import annotations

TASKS: dict[str, tuple[str, str]] = {
    "gripper": (
        """(define (domain gripper) (:requirements :strips)
          (:predicates (room ?r) (ball ?b) (hand ?h) (at-robby ?r) (at ?b ?r) (free ?h) (carry ?o ?h))
          (:action move :parameters (?from ?to) :precondition (and (room ?from) (room ?to) (at-robby ?from))
            :effect (and (at-robby ?to) (not (at-robby ?from))))
          (:action pick :parameters (?o ?r ?h)
            :precondition (and (ball ?o) (room ?r) (hand ?h) (at ?o ?r) (at-robby ?r) (free ?h))
            :effect (and (carry ?o ?h) (not (at ?o ?r)) (not (free ?h))))
          (:action drop :parameters (?o ?r ?h)
            :precondition (and (ball ?o) (room ?r) (hand ?h) (carry ?o ?h) (at-robby ?r))
            :effect (and (at ?o ?r) (free ?h) (not (carry ?o ?h)))))""",
        """(define (problem two) (:domain gripper) (:objects a b b1 b2 left right)
          (:init (room a) (room b) (ball b1) (ball b2) (hand left) (hand right) (at-robby a) (free left) (free right)
            (at b1 a) (at b2 a))
          (:goal (and (at b1 b) (at-robby b))))""",
    ),
    "blocks": (
        """(define (domain BLOCKS) (:requirements :strips :typing) (:types block)
          (:predicates (on ?x ?y - block) (ontable ?x - block) (clear ?x - block) (handempty) (holding ?x - block))
          (:action pick-up :parameters (?x - block) :precondition (and (clear ?x) (ontable ?x) (handempty))
            :effect (and (not (ontable ?x)) (not (clear ?x)) (not (handempty)) (holding ?x)))
          (:action put-down :parameters (?x - block) :precondition (holding ?x)
            :effect (and (not (holding ?x)) (clear ?x) (handempty) (ontable ?x)))
          (:action stack :parameters (?x ?y - block) :precondition (and (holding ?x) (clear ?y))
            :effect (and (not (holding ?x)) (not (clear ?y)) (clear ?x) (handempty) (on ?x ?y)))
          (:action unstack :parameters (?x ?y - block) :precondition (and (on ?x ?y) (clear ?x) (handempty))
            :effect (and (holding ?x) (clear ?y) (not (clear ?x)) (not (handempty)) (not (on ?x ?y)))))""",
        """(define (problem THREE) (:domain blocks) (:objects A B C - block)
          (:INIT (CLEAR A) (clear b) (ontable a) (ontable c) (on b c) (handempty)) (:goal (and (on a b))))""",
    ),
    "logistics": (
        """(define (domain logistics-like) (:requirements :strips :typing)
          (:types truck plane - vehicle package vehicle - thing airport spot - place city place thing)
          (:predicates (in-city ?p - place ?c - city) (at ?t - thing ?p - place) (in ?k - package ?v - vehicle))
          (:action load :parameters (?k - package ?v - vehicle ?p - place) :precondition (and (at ?v ?p) (at ?k ?p))
            :effect (and (not (at ?k ?p)) (in ?k ?v)))
          (:action unload :parameters (?k - package ?v - vehicle ?p - place) :precondition (and (at ?v ?p) (in ?k ?v))
            :effect (and (at ?k ?p) (not (in ?k ?v))))
          (:action drive :parameters (?t - truck ?a ?b - place ?c - city)
            :precondition (and (at ?t ?a) (in-city ?a ?c) (in-city ?b ?c)) :effect (and (not (at ?t ?a)) (at ?t ?b)))
          (:action fly :parameters (?f - plane ?a ?b - airport) :precondition (at ?f ?a)
            :effect (and (not (at ?f ?a)) (at ?f ?b))))""",
        """(define (problem l) (:domain logistics-like)
          (:objects t1 - truck f1 - plane k1 - package a1 a2 - airport s1 - spot c1 c2 - city)
          (:init (in-city a1 c1) (in-city s1 c1) (in-city a2 c2) (at t1 s1) (at k1 s1) (at f1 a1))
          (:goal (at k1 a1)))""",
    ),
    "sokoban": (
        """(define (domain sokoban) (:requirements :typing :negative-preconditions) (:types cell dir stone)
          (:predicates (next ?a ?b - cell ?d - dir) (me ?c - cell) (is ?s - stone ?c - cell) (full ?c - cell))
          (:action step :parameters (?a ?b - cell ?d - dir)
              :precondition (and (me ?a) (next ?a ?b ?d) (not (full ?b)))
            :effect (and (not (me ?a)) (me ?b)))
          (:action push :parameters (?s - stone ?a ?b ?c - cell ?d - dir)
            :precondition (and (me ?a) (next ?a ?b ?d) (next ?b ?c ?d) (is ?s ?b) (not (full ?c)))
            :effect (and (not (me ?a)) (me ?b) (not (is ?s ?b)) (is ?s ?c) (not (full ?b)) (full ?c))))""",
        """(define (problem s) (:domain sokoban) (:objects c1 c2 c3 c4 - cell l r - dir s - stone)
          (:init (next c1 c2 r) (next c2 c3 r) (next c3 c4 r) (next c2 c1 l) (next c3 c2 l) (next c4 c3 l)
            (me c1) (is s c2) (full c2)) (:goal (is s c4)))""",
    ),
    "add wins": (
        """(define (domain d) (:requirements :strips)
          (:predicates (p ?x) (q ?x ?x))
          (:action both :parameters (?x ?y)
              :precondition (p ?x) :effect (and (not (p ?x)) (p ?y) (not (q ?x ?y)) (q ?y ?x)))
          (:action all :parameters (?x) :precondition (q ?x ?x) :effect (and (not (p ?x)) (p ?x) (not (q ?x ?x))))
          (:action none :parameters ()))""",
        """(define (problem x) (:domain d) (:objects a b) (:init (p a) (q a a) (q b a)) (:goal (and (p b) (q a a))))""",
    ),
    "negative": (
        """(define (domain d) (:requirements :negative-preconditions) (:predicates (on ?x) (odd ?x) (link ?x ?y))
          (:action flip :parameters (?x ?y) :precondition (and (not (on ?x)) (not (link ?x ?y)) (odd ?y))
            :effect (and (on ?x) (when (on ?y) (not (on ?y)))))
          (:action off :parameters (?x) :precondition (not (not (on ?x))) :effect (not (on ?x))))""",
        """(define (problem x) (:domain d) (:objects a b c) (:init (odd a) (odd b) (link a b) (not (on a)))
          (:goal (and (on a) (not (on b)))))""",
    ),
    "disjunctive": (
        """(define (domain d) (:requirements :disjunctive-preconditions) (:predicates (p ?x) (q ?x) (s ?x))
          (:action a :parameters (?x ?y)
              :precondition (or (and (p ?x) (q ?y)) (not (or (p ?y) (s ?y)))) :effect (and (q ?x)))
          (:action b :parameters (?x)
              :precondition (imply (q ?x) (or (s ?x) (p ?x))) :effect (and (p ?x) (not (q ?x))))
          (:action c :parameters (?x) :precondition (and (or) (p ?x)) :effect (p ?x)))""",
        """(define (problem x) (:domain d) (:objects u v w) (:init (p u) (s v) (q w))
          (:goal (or (and (p w) (p v)) (q u))))""",
    ),
    "equality": (
        """(define (domain d) (:requirements :equality :disjunctive-preconditions) (:constants home)
          (:predicates (at ?x) (seen ?x ?y))
          (:action go :parameters (?x ?y)
              :precondition (and (at ?x) (not (= ?x ?y)) (or (= ?y home) (not (seen ?x ?y))))
            :effect (and (at ?y) (not (at ?x)) (seen ?x ?y)))
          (:action stay :parameters (?x ?y) :precondition (and (at ?x) (= ?x ?y) (= home home)) :effect ()))""",
        """(define (problem x) (:domain d) (:objects a b) (:init (at home)) (:goal (and (at a) (not (= a b)))))""",
    ),
    "quantified": (
        """(define (domain d) (:requirements :adl) (:types box ball - thing shelf)
          (:predicates (on ?t - thing ?s - shelf) (dusty ?s - shelf) (wide ?s - shelf) (same ?a ?b - thing))
          (:action put :parameters (?t - thing ?s - shelf)
            :precondition (and (forall (?o - shelf) (not (on ?t ?o)))
              (or (wide ?s) (not (exists (?o - thing) (and (not (same ?o ?t)) (on ?o ?s))))))
            :effect (on ?t ?s))
          (:action clean :parameters (?s - shelf) :precondition (forall (?t - thing) (imply (on ?t ?s) (same ?t ?t)))
            :effect (and (not (dusty ?s)) (forall (?t - ball) (not (on ?t ?s)))))
          (:action shake :parameters ()
            :precondition (exists (?t - thing ?s - shelf) (and (on ?t ?s)
              (forall (?z - shelf) (or (= ?z ?s) (dusty ?z)))))
            :effect (forall (?s - shelf) (forall (?t - thing)
              (when (not (dusty ?s)) (and (not (on ?t ?s)) (dusty ?s)))))))""",
        """(define (problem x) (:domain d) (:objects b1 - box l1 - ball s1 s2 - shelf)
          (:init (dusty s1) (dusty s2) (wide s2) (same b1 b1) (same l1 l1))
          (:goal (and (exists (?s - shelf) (not (dusty ?s)))
              (forall (?t - thing) (exists (?s - shelf) (on ?t ?s))))))""",
    ),
    "conditional": (
        """(define (domain d) (:requirements :conditional-effects :negative-preconditions) (:predicates (p ?x)
              (q ?x) (k ?x))
          (:action swap :parameters (?x ?y)
            :effect (and (when (p ?x) (p ?y)) (when (p ?y) (p ?x)) (when (not (p ?x)) (not (p ?y)))
              (when (not (p ?y)) (not (p ?x)))))
          (:action set :parameters (?x ?y) :precondition (k ?x)
            :effect (and (p ?x) (when (q ?y) (not (p ?y))) (when (k ?y) (and (q ?y) (not (q ?x))))))
          (:action wipe :parameters (?x)
              :effect (and (not (p ?x)) (when (not (q ?x)) (p ?x)) (forall (?y) (when (p ?y) (not (q ?y)))))))""",
        """(define (problem x) (:domain d) (:objects a b) (:init (p a) (k b) (q b)) (:goal (and (p a) (p b))))""",
    ),
    "derived": (
        """(define (domain d)
              (:requirements :derived-predicates :negative-preconditions :existential-preconditions :typing)
          (:types node)
          (:predicates (edge ?x ?y - node) (path ?x ?y - node) (stuck ?x - node) (at ?x - node))
          (:derived (path ?x ?y) (edge ?x ?y))
          (:derived (path ?x ?y - node) (exists (?z - node) (and (edge ?x ?z) (path ?z ?y))))
          (:derived (stuck ?x - node) (not (exists (?y - node) (path ?x ?y))))
          (:action jump :parameters (?x ?y - node)
              :precondition (and (at ?x) (path ?x ?y)) :effect (and (not (at ?x)) (at ?y)))
          (:action cut :parameters (?x ?y - node)
              :precondition (and (edge ?x ?y) (not (stuck ?y))) :effect (not (edge ?x ?y)))
          (:action tie :parameters (?x ?y - node) :precondition (and (at ?x) (stuck ?y))
            :effect (and (edge ?x ?y) (when (path ?y ?x) (not (edge ?y ?x))))))""",
        """(define (problem x) (:domain d) (:objects a b c - node) (:init (at a) (edge a b) (edge b c) (edge c b))
          (:goal (and (at c) (stuck b))))""",
    ),
    "derived at the end": (
        """(define (domain d) (:predicates (r ?x) (s ?x) (r-at-end ?x) (u ?x))
          (:derived (r ?x) (s ?x)) (:derived (r-at-end ?x) (u ?x))
          (:action a :parameters (?x ?y) :precondition (and (u ?x) (r-at-end ?x)) :effect (s ?y))
          (:action z :parameters (?x) :precondition (r ?x) :effect (and (u ?x) (not (s ?x)))))""",
        """(define (problem p) (:domain d) (:objects a b) (:init (u a) (s a)) (:goal (or (r b) (not (r-at-end b)))))""",
    ),
    "either": (
        """(define (domain d) (:requirements :typing) (:types cup pan bowl - thing)
          (:predicates (held ?x - (either cup pan)) (clean ?x - thing) (any ?x))
          (:action hold :parameters (?x - (either cup bowl))
              :precondition (clean ?x) :effect (and (held ?x) (any ?x)))
          (:action wash :parameters (?x - thing ?y)
              :precondition (held ?x) :effect (and (clean ?y) (not (held ?x)))))""",
        """(define (problem x) (:domain d) (:objects c - cup p - pan b - bowl o) (:init (clean c) (held p))
              (:goal (any b)))""",
    ),
    "names": (
        """(define (domain d-1) (:requirements :typing :negative-preconditions)
              (:types class Not-Here - object entity)
          (:constants true - class)
          (:predicates (holds ?x - class) (action ?x - class) (pick-up ?x - class) (pick_up ?x - class) (fluent)
              (free ?t - entity))
          (:action not :parameters (?class - class ?Class-2 - class)
              :precondition (and (action ?class) (not (holds ?Class-2)))
            :effect (and (holds ?class) (fluent)))
          (:action class :parameters (?x-y ?x_y - class) :precondition (holds ?x-y)
            :effect (and (pick-up ?x-y) (pick_up ?x_y) (not (fluent)))))""",
        """(define (problem p-1) (:domain D-1) (:objects class Not a-b a_b - class e - entity)
              (:init (action true) (action class) (action a-b))
          (:goal (and (pick-up a-b) (not (pick_up a-b)))))""",
    ),
    "costs": (
        """(define (domain d) (:requirements :action-costs) (:predicates (at ?x) (road ?x ?y))
          (:functions (total-cost) - number (way ?x ?y) - number)
          (:action go :parameters (?x ?y) :precondition (and (at ?x) (road ?x ?y))
            :effect (and (at ?y) (not (at ?x)) (increase (total-cost) (way ?x ?y))))
          (:action rest :parameters () :effect (increase (total-cost) 2)))""",
        """(define (problem x) (:domain d) (:objects a b c)
          (:init (at a) (road a b) (road b c) (road c a) (= (total-cost) 0) (= (way a b) 1) (= (way b c) 3) (=
              (way c a) 2))
          (:goal (at c)) (:metric minimize (total-cost)))""",
    ),
    "never": (
        """(define (domain d) (:requirements :typing :negative-preconditions) (:types room rooms)
          (:predicates (p ?x - room) (q ?x - rooms) (static ?x) (statics ?x))
          (:action move-1 :parameters (?x - room) :precondition (not (statics ?x)) :effect (p ?x))
          (:action move-2 :parameters (?x - rooms) :precondition (p ?x) :effect (and (q ?x) (not (p ?x))))
          (:action move-3 :parameters (?x - room) :precondition (and (static ?x) (p ?x)) :effect (not (p ?x))))""",
        """(define (problem x) (:domain d) (:objects a b - room) (:init) (:goal (and (p a) (not (p a)))))""",
    ),
}  # fmt: skip
"""Texts of a domain and of a problem by the names of what they are about."""
