"""What Deadline Cloud uploads of a bundle, by the classes of its own client: prints the paths.

Run by Deadline's Python, which has other versions of packages than we have (make acceptance).
"""

import sys
from pathlib import Path

import boto3
from deadline.client.job_bundle.parameters import apply_job_parameters, read_job_bundle_parameters
from deadline.client.job_bundle.submission import AssetReferences
from deadline.job_attachments.upload import S3AssetManager


def main(bundle: str) -> None:
    """Print every file that would be uploaded, one a line."""
    references = AssetReferences()
    apply_job_parameters([], bundle, read_job_bundle_parameters(bundle), references)
    files = {Path(file) for file in references.input_filenames}
    for folder in references.input_directories:
        files |= {file for file in Path(folder).rglob("*") if file.is_file()}
    session = boto3.Session("key", "secret", region_name="us-west-2")
    group = S3AssetManager(session=session).prepare_paths_for_upload(
        sorted(map(str, files)), sorted(references.output_directories), []
    )
    for root in group.asset_groups:
        sys.stdout.writelines(f"{file}\n" for file in sorted(map(str, root.inputs)))


if __name__ == "__main__":
    main(sys.argv[1])
