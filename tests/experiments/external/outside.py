# SPDX-License-Identifier: BSD-3-Clause
# Takes a program that is a cell through exported drives, without montecarta:
# outside.py COMMAND NAME DRIVE... writes DRIVE/NAME.csv.
import csv, json, math, shlex, subprocess, sys
program = subprocess.Popen(shlex.split(sys.argv[1]), stdin=subprocess.PIPE,
                           stdout=subprocess.PIPE, text=True)
said = 0
def ask(**message):
    global said
    said += 1
    print(json.dumps(dict(message, id=said)), file=program.stdin, flush=True)
    return json.loads(program.stdout.readline())
def rows(folder, name):
    return [[float(x) if x else None for x in row]
            for row in list(csv.reader(open(f"{folder}/{name}.csv")))[1:]]
settings = {"vehicle": "front_axle", "wheelbase": 4, "wheel_left": 0, "sensor_ahead": 0,
            "sensor_left": 0, "sigma_speed": 0.3, "sigma_steer": 3 / 180 * math.pi,
            "sigma_range": 0.1, "sigma_bearing": 1 / 180 * math.pi, "association": "known",
            "gate": 5.99, "new_gate": 25, "landmarks": 2}
for folder in sys.argv[3:]:
    ask(type="start", run=0, seed=1, start=rows(folder, "start")[0][1:], settings=settings)
    odometry, detections = rows(folder, "odometry"), rows(folder, "detections")
    with open(f"{folder}/{sys.argv[2]}.csv", "w") as out:
        print("time_s,x_m,y_m,heading_rad",
              *(f"cov_{i}_{j}" for i in range(3) for j in range(3)), sep=",", file=out)
        for time in sorted({row[0] for row in detections}):
            controls = []
            while odometry[0][0] < time:
                controls.append(odometry[0][1:] + [odometry[1][0] - odometry[0][0]])
                odometry = odometry[1:]
            seen = [[r, b, int(i)] for t, r, b, i in detections if t == time and r is not None]
            answer = ask(type="scan", controls=controls, detections=seen)
            P = [value for row in answer["covariance"] for value in row]
            print(*map(repr, map(float, [time, *answer["mean"], *P])), sep=",", file=out)
