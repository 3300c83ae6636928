"""The smallest good inputs: a box as CAD, a camera, a frame that shows nothing but a floor."""

import json
import struct
import zlib

CAMERA = {"width": 320, "height": 240, "fx": 400.0, "fy": 400.0, "cx": 159.5, "cy": 119.5,
          "depth_scale": 0.1}
FLOOR_MM = 400


def write_box_stl(path, size_mm=(40, 24, 16)):
    """A binary STL of twelve triangles."""
    corners = [[(i >> axis & 1) * size_mm[axis] for axis in range(3)] for i in range(8)]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))]
    with open(path, "wb") as file:
        file.write(b"box".ljust(80, b"\0") + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<3f", 0, 0, 0))
            for corner in triangle:
                file.write(struct.pack("<3f", *corners[corner]))
            file.write(struct.pack("<H", 0))


def write_png(path, bits, rows):
    """A gray PNG of 8 or 16 bits."""
    def chunk(kind, content):
        checksum = zlib.crc32(kind + content)
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", checksum)

    code = "B" if bits == 8 else "H"
    pixels = b"".join(b"\0" + struct.pack(f">{len(row)}{code}", *row) for row in rows)
    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), bits, 0, 0, 0, 0)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header))
        file.write(chunk(b"IDAT", zlib.compress(pixels)) + chunk(b"IEND", b""))


def write_camera(path):
    path.write_text(json.dumps(CAMERA))


def write_frame(folder):
    """depth.png and gray.png."""
    width, height = CAMERA["width"], CAMERA["height"]
    depth = round(FLOOR_MM / CAMERA["depth_scale"])
    write_png(folder / "depth.png", 16, [[depth] * width] * height)
    write_png(folder / "gray.png", 8, [[100] * width] * height)


def write_dataset(root):
    """The same frame as image 0 of scene 1, in the BOP layout, with nothing to be found in it."""
    scene = root / "test" / "000001"
    for kind in ("depth", "gray"):
        (scene / kind).mkdir(parents=True)
    write_frame(scene)
    (scene / "depth.png").rename(scene / "depth" / "000000.png")
    (scene / "gray.png").rename(scene / "gray" / "000000.png")
    c = CAMERA
    camera = {"cam_K": [c["fx"], 0, c["cx"], 0, c["fy"], c["cy"], 0, 0, 1],
              "depth_scale": c["depth_scale"]}
    (scene / "scene_camera.json").write_text(json.dumps({"0": camera}))
