// Closed loops of tactile servos, servo.comp.

CONSTANT(11, uint, CONTROL_PERIOD)  // frames
CONSTANT(12, bool, STARTS_AT_LOAD)  // the default reference of the force is that of the start record, not the total force of frame 0
CONSTANT(13, uint, FEATURE_ROWS)    // rows of an instance in servo_features
CONSTANT(14, uint, REGION_ROW)      // the row of its largest region
CONSTANT(15, bool, OBJECT_POSES)    // whether the host reads these outputs
CONSTANT(16, bool, SENSOR_POSES)
CONSTANT(17, bool, ACTIONS)
CONSTANT(18, bool, ROBOT_STATUS)
CONSTANT(19, bool, JOINTS)
CONSTANT(20, bool, MANIPULATOR)  // otherwise the sensor is free-flying, and the constants below are 1
CONSTANT(21, uint, NUM_JOINTS)
CONSTANT(22, uint, NUM_CHAIN_JOINTS)
CONSTANT(23, uint, TWIST_ROWS)  // selected components of a twist
CONSTANT(24, uint, GRAM_SIZE)   // the smaller one of TWIST_ROWS and NUM_JOINTS
CONSTANT(25, uint, DELAY)       // delay of the drives, frames

TEXELS(0, Instances)
UNIFORM(1, Step)
BUFFER(2, readonly, Objects)
BUFFER(3, readonly, Servos)
BUFFER(4, readonly, Loop)
BUFFER(5, readonly, LoopStarts)
BUFFER(6, readonly, Features)
BUFFER(7, readonly, ServoFeatures)
BUFFER(8, readwrite, LoopState)
BUFFER(9, writeonly, Poses)
BUFFER(10, writeonly, ObjectPoses)
BUFFER(11, writeonly, SensorPoses)
BUFFER(12, writeonly, Actions)
BUFFER(13, writeonly, RobotStatuses)
BUFFER(14, readonly, Robot)
BUFFER(15, writeonly, JointPositions)
BUFFER(16, writeonly, JointVelocities)

VALUE(kStateSensor, 0)       // X_WS: position, rotation
VALUE(kStateIntegral, 7)     // by feature
VALUE(kStateError, 14)       // errors of the control tick before, by feature; NaN if undefined
VALUE(kStateTwist, 21)       // commanded
VALUE(kStateLoadOffset, 27)  // m
VALUE(kStateStartForce, 28)  // N
VALUE(kStateStatus, 29)      // RobotStatus of the last motion
VALUE(kNumLoopState, 30)     // values of a free-flying sensor; a manipulator has kNumJointState + DELAY more per joint
VALUE(kJointPosition, 0)
VALUE(kJointVelocity, 1)
VALUE(kJointCommand, 2)
VALUE(kJointJacobian, 3)  // twist (v, w) of the sensor in S per unit velocity
VALUE(kNumJointState, 9)
