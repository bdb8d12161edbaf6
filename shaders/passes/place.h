// Objects, poses and loads, or contact points, from memory that another interface writes, place.comp.

CONSTANT(11, uint, SLOTS)        // slots of an instance
CONSTANT(12, uint, NUM_OBJECTS)  // objects of the model
CONSTANT(13, bool, LOADS)        // the frame is computed for loads
CONSTANT(14, bool, FRICTION)     // the skin needs motions
CONSTANT(15, float, BASE_X)      // SkinBase: normal
CONSTANT(16, float, BASE_Y)
CONSTANT(17, float, BASE_Z)
CONSTANT(18, float, BASE_LOWEST)
CONSTANT(19, float, BASE_ORIGIN)
CONSTANT(20, bool, OVER_TILES)  // loads are searched over tiles, from here:
CONSTANT(21, float, HIGHEST)    // LoadReach
CONSTANT(22, float, LOWEST)
CONSTANT(23, float, CLEARANCE)
CONSTANT(24, float, FIRST_STEP)
CONSTANT(25, uint, CONTACTS)           // capacity for contact points of an instance, which then takes no objects; 0
CONSTANT(26, float, LENGTH_TOLERANCE)  // kQuaternionTolerance limits the length of quaternions
CONSTANT(27, float, MOST_COORDINATE)   // m, kMaxContactCoordinate limits contact points
CONSTANT(28, float, MOST_FORCE)        // N, kMaxContactForce limits the force of a contact point

BUFFER(0, readwrite, Instances)
UNIFORM(1, Step)
BUFFER(2, readonly, Objects)
BUFFER(3, readonly, InputIds)
BUFFER(4, readonly, InputPoses)
BUFFER(5, readonly, InputLoads)
BUFFER(6, readonly, Features)
BUFFER(7, readwrite, PlacedPoses)
BUFFER(8, readwrite, Poses)
BUFFER(9, writeonly, Motions)
BUFFER(10, readwrite, InputProblems)
BUFFER(11, readonly, LoadBounds)
BUFFER(12, writeonly, Loads)
BUFFER(13, readonly, InputPositions)
BUFFER(14, readonly, InputForces)
BUFFER(15, readonly, InputCounts)
BUFFER(16, writeonly, Contacts)
BUFFER(17, writeonly, NumContacts)

VALUE(kPlacedNumbers, 8)   // numbers of a slot in placed_poses: object, position, rotation
VALUE(kObjectProblems, 0)  // words of input_problems
VALUE(kLoadProblems, 1)
VALUE(kContactProblems, 2)
VALUE(kNumInputProblems, 3)
