% SPDX-License-Identifier: BSD-3-Clause
% Prints the ANEES of every cell as `montecarta analyze` has it: anees('out.h5')
%
% At scans, over complete runs (status 1). Mean and covariance are the Gaussian mixture's where the
% file has them, else the spread of the particles (or the one Gaussian's own): rows `mixture`, or
% else `spread`, of consistency.csv. (What is called `corrected` there allows for few particles, and
% is not made here.) A singular covariance is judged in its range (STATISTICS 2); what is unusable
% is left out. Mean over the scans of a run, then over runs. Of imported estimates it is that of
% their stored errors, of any dimension. Only functions that Octave and MATLAB both have.
function anees(path)
  s = load_results(path);
  if isfield(s, 'sums')
    error('%s: has sums instead of runs: use montecarta analyze', path);
  end
  labels = fieldnames(s.cells);
  for k = 1:numel(labels)
    cell = s.cells.(labels{k});
    if isfield(cell, 'error')
      value = anees_of_errors(cell);
    else
      value = anees_of(cell, s.truth.pose, double(s.scan_row) + 1);
    end
    fprintf('%s %.17g\n', labels{k}, value);
  end
end

function value = anees_of_errors(cell)
  complete = find(cell.status(:) == 1);
  scans = size(cell.error, 2);
  average = nan(1, numel(complete));
  for r = 1:numel(complete)
    nees = nan(scans, 1);
    for k = 1:scans
      P = cell.error_covariance(:, :, k, complete(r))';
      allowed = 1e-6 * sqrt(diag(P)) * sqrt(diag(P))';
      if all(diag(P) >= 0) && all(all(abs(P - P') <= allowed))
        nees(k) = nees_of(cell.error(:, k, complete(r)), P, zeros(size(P, 1), 1));
      end
    end
    average(r) = mean_of_known(nees);
  end
  value = mean_of_known(average);
end

function value = anees_of(cell, truth, rows)
  which = '';
  if isfield(cell, 'pose_mean_mixture'), which = '_mixture'; end
  mean_pose = cell.(['pose_mean', which]);
  covariance = cell.(['pose_covariance', which]);
  complete = find(cell.status(:) == 1);
  nees = nan(numel(complete), numel(rows));
  for r = 1:numel(complete)
    e = truth(:, rows, complete(r)) - mean_pose(:, rows, complete(r));
    e(3, :) = e(3, :) - 2 * pi * round(e(3, :) / (2 * pi));
    for k = 1:numel(rows)
      P = covariance(:, :, rows(k), complete(r))';
      nees(r, k) = nees_of(e(:, k), P, [1e-9; 1e-9; 1e-10] .^ 2);  % [m, m, rad]^2
    end
  end
  average = nan(1, numel(complete));
  for r = 1:numel(complete), average(r) = mean_of_known(nees(r, :)); end
  value = mean_of_known(average);
end

function value = nees_of(e, P, least_variance)
  value = quadratic_form(e, P, least_variance);
  if isnan(value), value = nees_in_range(e, P, least_variance); end
  if value > 1e60, value = 1e60; end  % a larger NEES counts as this one
end

% Of a singular P, on the scale of all components; NaN if the sample is unusable.
function value = nees_in_range(e, P, least_variance)
  value = NaN;
  variance = diag(P);
  if ~all(isfinite(P(:))) || ~all(isfinite(e)) || any(variance < -least_variance), return; end
  is_open = variance > least_variance;
  lower = tril(P, -1) + tril(P, -1)';
  most = least_variance * max(variance, least_variance)';
  if any(any(lower(~is_open, :) .^ 2 > most(~is_open, :))), return; end
  if ~any(is_open), return; end
  scale = 1 ./ sqrt(variance(is_open));
  [vectors, eigenvalues] = eig((lower(is_open, is_open) + diag(variance(is_open))) ...
                               .* (scale * scale'));
  eigenvalues = diag(eigenvalues);
  along = vectors' * (scale .* e(is_open));
  if any(eigenvalues < -1e-9), return; end
  inside = eigenvalues > 1e-12;
  rank = sum(inside);
  sum_inside = sum(along(inside) .^ 2 ./ eigenvalues(inside));
  if sum(along(~inside) .^ 2) > 10 ^ 2, sum_inside = 1e60; end
  tail = gammainc(sum_inside / 2, rank / 2, 'upper');  % chi-square
  beyond = @(tail, d) 2 * gammaincinv(tail, d / 2, 'upper');
  if tail > 1e-6
    value = beyond(tail, numel(e));
  else
    value = sum_inside * beyond(1e-6, numel(e)) / beyond(1e-6, rank);
  end
end

% e' P^-1 e by Cholesky of the correlation matrix; NaN where P is singular.
function value = quadratic_form(e, P, least_variance)
  value = NaN;
  if ~all(diag(P) > least_variance) || ~all(isfinite(P(:))), return; end
  scale = sqrt(diag(P));
  L = zeros(numel(e));
  y = zeros(numel(e), 1);
  for i = 1:numel(e)
    for j = 1:i - 1
      L(i, j) = (P(i, j) / (scale(i) * scale(j)) - L(i, 1:j - 1) * L(j, 1:j - 1)') / L(j, j);
    end
    pivot = 1 - L(i, 1:i - 1) * L(i, 1:i - 1)';
    if ~(pivot > 1e-12), return; end
    L(i, i) = sqrt(pivot);
    y(i) = (e(i) / scale(i) - L(i, 1:i - 1) * y(1:i - 1)) / L(i, i);
  end
  value = sum(y .^ 2);
end

function value = mean_of_known(values)
  value = mean(values(~isnan(values)));
end
