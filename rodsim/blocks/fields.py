"""Where the numbers of the blocks of a scene lie in ``fixed``, which their parts share.

``fixed`` is: a head; a record of each block; a record of each member; the matrices and surface
points that they name by their first place; then room for what one evaluation leaves to the next
part, "left"; and at the end the gauges. Offsets count from the start of ``fixed``.
"""

# head; first the addresses of two sums, each with its runs: of u and w, and of u alone
(SUM, RUN, SUM_U, RUN_U, BLOCKS, MEMBERS, VISCOSITY, EPSILON, WALL, COUPLED, FLOW, FLOW_END, SIZE,
 COLUMNS, MEMBER_LEFT, BLOCK_LEFT, VECTORS, GAUGES, HELD, MOTOR_COUNT) = range(20)  # fmt: skip
HEAD = 20

# of a block: its node (-1: none), members, surface points and blobs, matrices, given motion
(NODE, FIRST, COUNT, SURFACE, POINTS, BLOB, ROD_BLOB, COLS, FREE, P, G, INVERSE, MOTION, VECTOR,
 COLUMN, SKIN, ORIGIN) = range(17)  # fmt: skip
BLOCK = 20  # ORIGIN takes three

# of a member: node, block, place and triad in the block's frame, its joint
M_NODE, M_BLOCK, ARM, TRIAD = 0, 1, 2, 5
JOINT, SPIN, SPINS, AXIS, ACROSS, AROUND = 14, 15, 16, 17, 20, 23
MOTOR, MOTOR_ROW, LINE, BENDING, TWISTING, ROTOR, DIRECTIONS = 26, 27, 28, 29, 30, 31, 32
MEMBER = 41  # DIRECTIONS: those of up to three free spins

# joints: the triad follows the block; turns about an axis; is free; is free but for a spring
CLAMPED, TURNING, BALL, HOOKED = range(4)
STILL, RATE, TORQUE = range(3)  # motors

# left of a member: load (6), torque of its hook (3), energy of its hook, torque and rate of motor
LOAD, SPRING, ENERGY, MOTOR_TORQUE, MOTOR_RATE = 0, 6, 9, 10, 11
LEFT = 12

# left of a block: its frame X (3), R (9); given U, Omega (6); load from outside (6); what holds it
# (6), about X
PLACE, TURN, GIVEN, OUTSIDE, HOLDER = 0, 3, 12, 18, 24
BLOCK_ROOM = 30

MOTION_ROW = 12  # numbers of a given motion: displacement, its rate, rotation vector, its rate

# gauges: power of what holds blocks and of motors; a correction of the power of a background flow;
# then the forces (H, 3) of what holds blocks, their torques (H, 3), the torques (K,) and the rates
# (K,) of motors
ANCHORS, MOTORS, STRESSLETS, HOLDERS = range(4)
