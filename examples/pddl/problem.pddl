; Three rooms around a hall that is wet.
(define (problem two-parcels)
  (:domain couriers)
  (:objects hall office store - room p1 p2 - parcel left right - hand)
  (:init
    (door hall office) (door office hall) (door hall store) (door store hall) (wet hall)
    (robot-at hall) (lies p1 store) (lies p2 store) (free left) (free right)
    (= (total-cost) 0) (= (way hall office) 2) (= (way office hall) 2) (= (way hall store) 1) (= (way store hall) 1))
  (:goal (and (lies p1 office) (lies p2 office) (not (dirty p1)) (not (dirty p2))))
  (:metric minimize (total-cost)))
