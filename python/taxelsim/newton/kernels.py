"""Warp kernels that write poses and contact points of all worlds into the inputs of a Simulator.

Newton has poses in float32, with quaternions (x, y, z, w). They are composed in float64, so that composition does not round them.
"""

from __future__ import annotations

import warp as wp


@wp.func
def doubled(v: wp.vec3f) -> wp.vec3d:
    """A vector in float64."""
    return wp.vec3d(wp.float64(v[0]), wp.float64(v[1]), wp.float64(v[2]))


@wp.func
def pose_of(X: wp.transformf) -> wp.transformd:
    """A pose in float64, its quaternion normalized."""
    q = wp.transform_get_rotation(X)
    rotation = wp.quatd(wp.float64(q[0]), wp.float64(q[1]), wp.float64(q[2]), wp.float64(q[3]))
    return wp.transformd(doubled(wp.transform_get_translation(X)), wp.normalize(rotation))


@wp.func
def in_world(body: wp.int32, shape: wp.int32, body_q: wp.array[wp.transformf], shape_transform: wp.array[wp.transformf]) -> wp.transformd:
    """Pose in W of a shape on a body, or of the body where the shape is -1. A body of -1 is the world."""
    X = wp.transform_identity(dtype=wp.float64)
    if shape >= 0:
        X = pose_of(shape_transform[shape])
    if body >= 0:
        X = wp.transform_multiply(pose_of(body_q[body]), X)
    return X


@wp.kernel(enable_backward=False)
def place_objects(
    body_q: wp.array[wp.transformf],
    shape_transform: wp.array[wp.transformf],
    shape_body: wp.array[wp.int32],
    frames: wp.array2d[wp.int32],
    shapes: wp.array2d[wp.int32],
    rotations: wp.array[wp.quatd],
    poses: wp.array3d[wp.float64],
) -> None:
    """X_SO (N, S, 7) of the objects.

    frames (N, 2): body and site of the sensor. shapes (N, S). rotations (S): R_GO in the frame G of the shape.
    """
    world, slot = wp.tid()
    shape = shapes[world, slot]
    X_WS = in_world(frames[world, 0], frames[world, 1], body_q, shape_transform)
    X_WG = in_world(shape_body[shape], shape, body_q, shape_transform)
    X_SG = wp.transform_multiply(wp.transform_inverse(X_WS), X_WG)
    p = wp.transform_get_translation(X_SG)
    q = wp.normalize(wp.transform_get_rotation(X_SG) * rotations[slot])
    for i in range(3):
        poses[world, slot, i] = p[i]
        poses[world, slot, 4 + i] = q[i]
    poses[world, slot, 3] = q[3]


@wp.func
def add_contact(
    world: wp.int32,
    X_WS: wp.transformd,
    p_W: wp.vec3d,
    f_W: wp.vec3d,
    positions: wp.array3d[wp.float64],
    normal_forces: wp.array2d[wp.float64],
    num_contacts: wp.array[wp.int32],
) -> None:
    """Appends a contact point with its force on the sensor, if that presses. Points beyond the capacity are counted alone."""
    X_SW = wp.transform_inverse(X_WS)
    pressing = -wp.transform_vector(X_SW, f_W)[2]
    if pressing > wp.float64(0.0):
        index = wp.atomic_add(num_contacts, world, 1)
        if index < positions.shape[1]:
            p = wp.transform_point(X_SW, p_W)
            for i in range(3):
                positions[world, index, i] = p[i]
            normal_forces[world, index] = pressing


@wp.kernel(enable_backward=False)
def gather_contacts(
    body_q: wp.array[wp.transformf],
    shape_transform: wp.array[wp.transformf],
    shape_body: wp.array[wp.int32],
    frames: wp.array2d[wp.int32],
    world_of: wp.array[wp.int32],
    count: wp.array[wp.int32],
    shapes_0: wp.array[wp.int32],
    shapes_1: wp.array[wp.int32],
    points_0: wp.array[wp.vec3f],
    points_1: wp.array[wp.vec3f],
    offsets_0: wp.array[wp.vec3f],
    offsets_1: wp.array[wp.vec3f],
    forces: wp.array[wp.spatial_vectorf],
    positions: wp.array3d[wp.float64],
    normal_forces: wp.array2d[wp.float64],
    num_contacts: wp.array[wp.int32],
) -> None:
    """Contact points of the sensors from the first `count` of Newton's contacts: midpoint of both surfaces, force on shape 0.

    world_of (shapes): world whose sensor lies on the body of a shape, or -1.
    """
    contact = wp.tid()
    if contact >= count[0]:
        return
    shape_0 = shapes_0[contact]
    shape_1 = shapes_1[contact]
    point_0 = doubled(points_0[contact] + offsets_0[contact])
    point_1 = doubled(points_1[contact] + offsets_1[contact])
    X_W0 = in_world(shape_body[shape_0], -1, body_q, shape_transform)
    X_W1 = in_world(shape_body[shape_1], -1, body_q, shape_transform)
    p_W = wp.float64(0.5) * (wp.transform_point(X_W0, point_0) + wp.transform_point(X_W1, point_1))
    f_W = doubled(wp.spatial_top(forces[contact]))
    world = world_of[shape_0]
    if world >= 0:
        X_WS = in_world(frames[world, 0], frames[world, 1], body_q, shape_transform)
        add_contact(world, X_WS, p_W, f_W, positions, normal_forces, num_contacts)
    world = world_of[shape_1]
    if world >= 0:
        X_WS = in_world(frames[world, 0], frames[world, 1], body_q, shape_transform)
        add_contact(world, X_WS, p_W, -f_W, positions, normal_forces, num_contacts)
