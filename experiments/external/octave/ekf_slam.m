% SPDX-License-Identifier: BSD-3-Clause
function ekf_slam()
% EKF-SLAM with known association (EQUATIONS 1, 2, 15). Gives the numbers of the cell ekf_slam.
  montecarta_filter(struct('start', @start, 'predict', @predict, 'update', @update, ...
                           'estimate', @estimate, 'report', @(b) b.said, 'map', @map));
end

function b = start(pose, settings, run, seed)
  assert(strcmp(settings.association, 'known') && strcmp(settings.vehicle, 'front_axle'));
  b.wheelbase = settings.wheelbase;
  b.Q = diag([settings.sigma_speed settings.sigma_steer].^2);
  b.R = diag([settings.sigma_range settings.sigma_bearing].^2);
  b.m = pose(:);  % pose, then x and y of each landmark in order of initialisation
  b.P = zeros(3);
  b.row_of = zeros(1, settings.landmarks);  % index in m and P, by identity + 1; 0: not mapped
  b.said = struct();
end

function b = predict(b, speed, steer, duration)
  c = b.m(3) + steer;
  way = speed * duration;
  dx = way * cos(c);
  dy = way * sin(c);
  F = [1 0 -dy; 0 1 dx; 0 0 1];
  G = duration * [cos(c) -speed*sin(c); sin(c) speed*cos(c); ...
                  [sin(steer) speed*cos(steer)] / b.wheelbase];
  b.m(1:3) = b.m(1:3) + [dx; dy; way * sin(steer) / b.wheelbase];
  b.m(3) = wrapped(b.m(3));
  b.P(1:3, :) = F * b.P(1:3, :);
  b.P(:, 1:3) = b.P(:, 1:3) * F';
  b.P(1:3, 1:3) = b.P(1:3, 1:3) + G * b.Q * G';
end

function b = update(b, detections)
  b.said = struct('log_likelihood', 0, 'nis', 0, 'nis_dof', 0, 'map_size', 0);
  detections = detections(detections(:, 3) >= 0, :);
  is_known = b.row_of(detections(:, 3) + 1) > 0;
  for z = detections(is_known, :)'
    b = update_with(b, z(1), z(2), b.row_of(z(3) + 1));
  end
  for z = detections(~is_known, :)'
    b = append(b, z(1), z(2), z(3));
  end
  b.said.map_size = nnz(b.row_of);
end

function b = update_with(b, r, bearing, row)
  delta = b.m(row:row+1) - b.m(1:2);
  d = norm(delta);
  Hf = [delta'; -delta(2)/d delta(1)/d] / d;
  H = zeros(2, numel(b.m));
  H(:, [1 2 row row+1]) = [-Hf Hf];
  H(2, 3) = -1;
  v = [r - d; wrapped(bearing - (atan2(delta(2), delta(1)) - b.m(3)))];
  PHt = b.P * H';
  S = H * PHt + b.R;
  K = PHt / S;
  b.m = b.m + K * v;
  b.m(3) = wrapped(b.m(3));
  b.P = b.P - K * PHt';
  b.P = (b.P + b.P') / 2;
  nis = v' * (S \ v);
  b.said.nis = b.said.nis + nis;
  b.said.nis_dof = b.said.nis_dof + 2;
  b.said.log_likelihood = b.said.log_likelihood - 0.5 * (nis + log(det(2*pi*S)));
end

function b = append(b, r, bearing, identity)
  c = cos(b.m(3) + bearing);
  s = sin(b.m(3) + bearing);
  Gx = [1 0 -r*s; 0 1 r*c];
  Gz = [c -r*s; s r*c];
  cross = Gx * b.P(1:3, :);
  b.P = [b.P cross'; cross (cross(:, 1:3) * Gx' + Gz * b.R * Gz')];
  b.row_of(identity + 1) = numel(b.m) + 1;
  b.m = [b.m; b.m(1:2) + r * [c; s]];
end

function [mean, covariance] = estimate(b)
  mean = b.m(1:3);
  covariance = b.P(1:3, 1:3);
end

function rows = map(b)
  rows = zeros(0, 6);
  for identity = find(b.row_of) - 1
    i = b.row_of(identity + 1);
    rows(end+1, :) = [identity b.m(i:i+1)' b.P(i, i) b.P(i, i+1) b.P(i+1, i+1)];
  end
end

function angle = wrapped(angle)
  angle = angle - 2*pi * round(angle / (2*pi));
end
