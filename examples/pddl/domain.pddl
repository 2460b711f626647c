; A robot with two hands carries parcels between rooms, whose doors may be shut.
(define (domain couriers)
  (:requirements :strips :typing :negative-preconditions :conditional-effects :action-costs)
  (:types room parcel hand)
  (:predicates
    (door ?a ?b - room) (shut ?a ?b - room) (robot-at ?r - room)
    (lies ?p - parcel ?r - room) (holds ?h - hand ?p - parcel) (free ?h - hand) (wet ?r - room) (dirty ?p - parcel))
  (:functions (total-cost) - number (way ?a ?b - room) - number)

  (:action go
    :parameters (?a ?b - room)
    :precondition (and (robot-at ?a) (door ?a ?b) (not (shut ?a ?b)))
    :effect (and (robot-at ?b) (not (robot-at ?a)) (increase (total-cost) (way ?a ?b))))

  (:action pick-up
    :parameters (?p - parcel ?r - room ?h - hand)
    :precondition (and (robot-at ?r) (lies ?p ?r) (free ?h))
    :effect (and (holds ?h ?p) (not (lies ?p ?r)) (not (free ?h)) (increase (total-cost) 1)))

  (:action put-down
    :parameters (?p - parcel ?r - room ?h - hand)
    :precondition (and (robot-at ?r) (holds ?h ?p))
    :effect (and (lies ?p ?r) (free ?h) (not (holds ?h ?p)) (when (wet ?r) (dirty ?p)) (increase (total-cost) 1))))
